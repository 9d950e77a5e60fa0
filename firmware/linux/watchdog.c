/* A timer of the kernel, which ends a loop that hangs. A process that does not run at all finds out when it runs again. */
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <time.h>
#include "hal.h"
#include "linux.h"
#include "protocol.h"
#include "system.h"

enum { MS_NS = 1000000, FEED_MS = 20 };

static timer_t timer;
static bool is_started;
static uint64_t fed_ns;

static void on_alarm(int number)
{
    (void)number;
    linux_reset(RESET_WATCHDOG, "the board stood still for 250 ms");
}

static void feed(void)
{
    const struct itimerspec bites = { .it_value = { 0, WATCHDOG_MS * (long)MS_NS } };
    timer_settime(timer, 0, &bites, NULL);
    fed_ns = system_ns();
}

void hal_start_watchdog(void)
{
    struct sigevent alarm = { .sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGALRM };
    signal(SIGALRM, on_alarm);
    if (timer_create(CLOCK_MONOTONIC, &alarm, &timer))
        linux_fail("the kernel gives no timer (%s)", strerror(errno));
    is_started = true;
    feed();
}

/* Each call costs a turn of the kernel, and there is one in each millisecond. */
void hal_feed_watchdog(void)
{
    if (is_started && system_ns() - fed_ns >= FEED_MS * (uint64_t)MS_NS)
        feed();
}
