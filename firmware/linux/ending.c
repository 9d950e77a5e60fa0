/* The end of the process, or of the board that it is; and what it says on the way. */
#define _GNU_SOURCE
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
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
enum { SOON_S = 10 };           /* the same is not said again so soon */
enum { TEXT_SIZE = 512, TOLD = 8, FNV_BASIS = 0x811c9dc5, FNV_PRIME = 0x01000193 };

static char **arguments;
static void (*stop_all)(void);
static uint64_t began_ns;

/* What was said lately, as hashes. */
static struct { uint32_t text, at_s; } told[TOLD];

/* The environment of the program that begins anew after a reset: why, and the bytes of told[]. */
static char cause_text[] = "RESET_CAUSE=0";
static char told_text[sizeof "RESET_TOLD=" + 2 * sizeof told] = "RESET_TOLD=";

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

static bool is_news(const char *text)
{
    uint32_t hash = FNV_BASIS, now_s = (uint32_t)(boottime_ns() / S_NS), oldest = 0;
    for (const char *letter = text; *letter; letter++)
        hash = (hash ^ (uint8_t)*letter) * FNV_PRIME;
    for (uint32_t i = 0; i < TOLD; i++) {
        if (told[i].text == hash && now_s - told[i].at_s < SOON_S)
            return false;
        if (told[i].at_s < told[oldest].at_s)
            oldest = i;
    }
    told[oldest].text = hash;
    told[oldest].at_s = now_s;
    return true;
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

bool linux_say(const char *format, ...)
{
    char text[TEXT_SIZE];
    va_list given;
    va_start(given, format);
    vsnprintf(text, sizeof text, format, given);
    va_end(given);
    if (!is_news(text))
        return false;
    put("", text);
    return true;
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
    if (is_news(why))
        put("the motors are stopped, and the board begins anew: ", why);
    cause_text[sizeof cause_text - 2] = (char)('0' + cause);
    char *to = told_text + sizeof "RESET_TOLD=" - 1;
    for (size_t i = 0; i < sizeof told; i++) {
        uint8_t byte = ((const uint8_t *)told)[i];
        *to++ = (char)('a' + (byte >> 4));
        *to++ = (char)('a' + (byte & 15));
    }
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    execve("/proc/self/exe", arguments, (char *const[]){ cause_text, told_text, NULL });
    _exit(EXIT_FAILURE);
}

void linux_begin(char **words, void (*let_go)(void))
{
    arguments = words;
    stop_all = let_go;
    began_ns = boottime_ns();
    const char *from = getenv("RESET_TOLD");
    for (size_t i = 0; from && strlen(from) == 2 * sizeof told && i < sizeof told; i++)
        ((uint8_t *)told)[i] = (uint8_t)((from[2 * i] - 'a') << 4 | (from[2 * i + 1] - 'a'));
}

/* enum reset_cause has one digit for each. */
uint8_t hal_take_reset_cause(void)
{
    const char *cause = getenv("RESET_CAUSE");
    return (uint8_t)(cause ? *cause - '0' : RESET_POWER_ON);
}
