/* The serial line to the motor controller. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <stdbool.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>
#include "controller.h"
#include "linux.h"
#include "protocol.h"
#include "system.h"

static int line = -1;
static volatile bool is_over;           /* its last bytes were a stop */
static const struct protocol *spoken;

/* Only for what does not come by itself: an adapter that is not plugged in does. */
static void complain(const char *path)
{
    switch (errno) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case EIO:
        return;
    case EBUSY:
    case EWOULDBLOCK:
        linux_fail("%s is in use by another program: end it", path);
    case EACCES:
        linux_fail("%s may not be opened: add this user to the group that owns it", path);
    default:
        linux_fail("%s cannot be used as the controller's serial port (%s)", path, strerror(errno));
    }
}

/* A byte from anybody else would keep a dead command alive. TIOCEXCL keeps out who comes later, and flock() root, too. */
static bool try_open(const char *path)
{
    line = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (line >= 0 && (ioctl(line, TIOCEXCL) || flock(line, LOCK_EX | LOCK_NB))) {
        int error = errno;
        close(line);
        line = -1;              /* no stop goes to what somebody else has */
        errno = error;
    }
    return line >= 0;
}

/* What was sent before stays: it is a stop, if anything. */
static void set_line(void)
{
    struct termios raw;
    struct serial_struct adapter;
    tcgetattr(line, &raw);
    cfmakeraw(&raw);
    raw.c_cflag |= CLOCAL;
    raw.c_cflag &= ~(tcflag_t)(HUPCL | CRTSCTS | CSTOPB);
    cfsetspeed(&raw, spoken->baud);
    tcsetattr(line, TCSANOW, &raw);
    if (!ioctl(line, TIOCGSERIAL, &adapter)) {          /* some would hold each reply up for 16 ms */
        adapter.flags |= ASYNC_LOW_LATENCY;
        ioctl(line, TIOCSSERIAL, &adapter);
    }
    tcflush(line, TCIFLUSH);
}

void line_open(const char *path, const struct protocol *of_controller)
{
    spoken = of_controller;
    const struct timespec pause = { 0, 100000000 };
    for (bool is_told = false; !try_open(path); is_told = true) {
        complain(path);
        if (!is_told)
            linux_say("there is no %s: the board waits for it", path);
        nanosleep(&pause, NULL);
    }
    set_line();
}

int line_descriptor(void)
{
    return line;
}

void line_stop(void)
{
    is_over = true;
    if (line >= 0 && write(line, spoken->stop, spoken->stop_bytes) < 0)
        return;                 /* then only the controller's own time-out stops it */
}

/* A descriptor never comes back. */
static void judge(ssize_t done)
{
    if (done == 0 || (done < 0 && errno != EAGAIN && errno != EINTR))
        linux_reset(RESET_EXTERNAL, "the serial port of the controller is gone");
}

void system_line_write(const uint8_t *bytes, uint8_t n)
{
    if (is_over)
        return;                 /* another thread ends the process */
    judge(write(line, bytes, n));       /* one that is cut short stays without an answer */
}

uint8_t system_line_read(uint8_t *to, uint8_t room)
{
    ssize_t n = read(line, to, room);
    judge(n);
    return (uint8_t)(n > 0 ? n : 0);
}
