/* The end of the process, or of the board that it is; and what it says on the way. */
#define _GNU_SOURCE
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>
#include "hal.h"
#include "linux.h"
#include "protocol.h"
#include "system.h"

enum { MS_NS = 1000000, S_NS = 1000 * MS_NS };
enum { TEXT_SIZE = 512 };

static char **arguments;
static void (*stop_all)(void);
static uint64_t began_ns;

/* The environment of the program that begins anew after a reset. */
static char cause_text[] = "RESET_CAUSE=0";

/* The time counts in which the computer sleeps: what was sent before is old then. */
static uint64_t boottime_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_BOOTTIME, &now);
    return (uint64_t)now.tv_sec * S_NS + (uint64_t)now.tv_nsec;
}

uint64_t system_ns(void)
{
    return boottime_ns() - began_ns;
}

/* In one write, and by nothing that a handler of signals may not call. */
static void put(const char *beginning, const char *text)
{
    const char *const parts[] = { BOARD ": ", beginning, text, "\n" };
    struct iovec all[4];
    for (int i = 0; i < 4; i++)
        all[i] = (struct iovec){ .iov_base = (void *)(uintptr_t)parts[i], .iov_len = strlen(parts[i]) };
    struct pollfd out = { .fd = STDERR_FILENO, .events = POLLOUT };
    if (poll(&out, 1, 0) == 1 && writev(STDERR_FILENO, all, 4) < 0)
        return;                 /* nobody listens, and nothing waits for who does not read */
}

void linux_say(const char *format, ...)
{
    char text[TEXT_SIZE];
    va_list given;
    va_start(given, format);
    vsnprintf(text, sizeof text, format, given);
    va_end(given);
    put("", text);
}

void linux_fail(const char *format, ...)
{
    char text[TEXT_SIZE];
    va_list given;
    stop_all();
    va_start(given, format);
    vsnprintf(text, sizeof text, format, given);
    va_end(given);
    put("", text);
    _exit(EXIT_FAILURE);
}

/* All descriptors close. A mask outlasts exec, and this may be the handler of a signal, which masks itself. */
void linux_reset(uint8_t cause, const char *why)
{
    stop_all();
    put("the motors are stopped, and the board begins anew: ", why);
    cause_text[sizeof cause_text - 2] = (char)('0' + cause);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    execve("/proc/self/exe", arguments, (char *const[]){ cause_text, NULL });
    _exit(EXIT_FAILURE);
}

void linux_begin(char **words, void (*let_go)(void))
{
    arguments = words;
    stop_all = let_go;
    began_ns = boottime_ns();
}

/* enum reset_cause has one digit for each. */
uint8_t hal_take_reset_cause(void)
{
    const char *cause = getenv("RESET_CAUSE");
    return (uint8_t)(cause ? *cause - '0' : RESET_POWER_ON);
}
