/* What stops is chosen by the battery's voltage, which nothing else here looks at. */
#include "hal.h"
#include "machine.h"

enum { LOOP_HANGS = 2, CLOCK_STANDS = 3, LOOP_HANGS_UNWATCHED = 4 };

void __real_firmware_poll(void);
void __real_firmware_on_millisecond(void);
void __wrap_firmware_poll(void);
void __wrap_firmware_on_millisecond(void);

static int what_stops(void)
{
    return (int)machine_board->battery_volts;
}

void __wrap_firmware_poll(void)
{
    if (what_stops() != LOOP_HANGS && what_stops() != LOOP_HANGS_UNWATCHED)
        __real_firmware_poll();
}

void __wrap_firmware_on_millisecond(void)
{
    if (what_stops() == LOOP_HANGS_UNWATCHED)
        hal_feed_watchdog();
    if (what_stops() != CLOCK_STANDS)
        __real_firmware_on_millisecond();
}
