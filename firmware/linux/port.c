/* The serial port that the host opens: a pseudo terminal, found by a link. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>
#include "hal.h"
#include "linux.h"
#include "system.h"
#include "uart.h"

static const char TERMINALS[] = "/dev/pts/";

static const char *path;
static char fresh[PATH_MAX];            /* the link before it is in place */
static struct stat folder;
static int master = -1;

/* A link that is there is that of a process that has ended: its number may be somebody else's terminal by now. */
void port_choose(const char *link_path)
{
    char text[PATH_MAX] = "";
    if (snprintf(text, sizeof text, "%s", link_path) >= PATH_MAX - (int)sizeof ".new")
        linux_fail("the path of the port is too long: name a shorter one");
    const char *folder_path = dirname(text);
    if (stat(folder_path, &folder) || access(folder_path, W_OK | X_OK))
        linux_fail("no link can be made in %s (%s): make that folder, or name another one", folder_path, strerror(errno));
    snprintf(fresh, sizeof fresh, "%s.new", link_path);
    memset(text, 0, sizeof text);
    ssize_t n = readlink(link_path, text, sizeof text - 1);
    if (n < 0 ? errno != ENOENT : strncmp(text, TERMINALS, sizeof TERMINALS - 1) != 0)
        linux_fail("%s is there, and is no board's port: name another path", link_path);
    char lock_path[PATH_MAX + sizeof ".lock"];
    snprintf(lock_path, sizeof lock_path, "%s.lock", link_path);
    int lock = open(lock_path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);     /* held as long as the process is there */
    if (lock < 0 || flock(lock, LOCK_EX | LOCK_NB))
        linux_fail("%s is the port of another board, or cannot be: end that, or name another path", link_path);
    path = link_path;
    port_remove();
}

void port_remove(void)
{
    if (path)
        unlink(path);
}

int port_descriptor(void)
{
    return master;
}

/* Whoever owns the link's folder decides who may open the board. */
static void share(int slave)
{
    if (fchown(slave, (uid_t)-1, folder.st_gid) || fchmod(slave, 0660))
        linux_say("the group of the folder of %s may not open the board (%s)", path, strerror(errno));
}

/* The link comes last: no board is there before it has started. */
void hal_start_uart(void)
{
    struct termios raw;
    master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    const char *name = master >= 0 && !grantpt(master) && !unlockpt(master) ? ptsname(master) : NULL;
    int slave = name ? open(name, O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;  /* held: a host that closes it ends nothing */
    if (slave < 0)
        linux_fail("the kernel gives no pseudo terminal (%s)", strerror(errno));
    tcgetattr(slave, &raw);
    cfmakeraw(&raw);
    tcsetattr(slave, TCSANOW, &raw);
    share(slave);
    unlink(fresh);
    if (symlink(name, fresh) || rename(fresh, path))
        linux_fail("the link %s cannot be made (%s)", path, strerror(errno));
}

/* What nobody reads is lost, as on a wire. */
void hal_transmit(void)
{
    uint8_t bytes[128];
    size_t n = 0;
    for (int16_t byte; n < sizeof bytes && (byte = uart_on_transmit()) >= 0;)
        bytes[n++] = (uint8_t)byte;
    if (n && write(master, bytes, n) < 0)
        return;
}

uint8_t system_port_read(uint8_t *to, uint8_t room)
{
    ssize_t n = read(master, to, room);
    return (uint8_t)(n > 0 ? n : 0);
}
