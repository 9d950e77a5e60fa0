#include <stdint.h>
#include "clock.h"
#include "hal.h"
#include "watchdog.h"

static uint32_t fed_ms;

void watchdog_start(void)
{
    fed_ms = clock_ms();
    hal_start_watchdog();
}

void watchdog_poll(void)
{
    uint32_t now = clock_ms();
    if (now == fed_ms)
        return;         /* a loop that runs proves nothing while the clock, and all time-outs with it, stands */
    fed_ms = now;
    hal_feed_watchdog();
}
