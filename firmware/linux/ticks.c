#include "ticks.h"
#include "clock.h"
#include "hal.h"
#include "system.h"

enum { MS_NS = 1000000 };

static uint64_t next_ns;                /* the millisecond under way ends; 0 = the clock has not begun */

uint64_t ticks_due_ns(void)
{
    return next_ns;
}

bool ticks_take_due(void)
{
    if (!next_ns || system_ns() < next_ns)
        return false;
    next_ns += MS_NS;
    return true;
}

void hal_enable_interrupts(void)
{
}

void hal_start_clock(void)
{
    next_ns = system_ns() + MS_NS;
}

/* Since the newest millisecond that was counted. One that is later than a stamp can tell is late enough. */
static uint16_t clock_counts(void)
{
    uint64_t since_ns = system_ns() + MS_NS - next_ns;
    return (uint16_t)((since_ns < 3 * MS_NS ? since_ns : 3 * MS_NS) * CLOCK_COUNTS_PER_MS / MS_NS);
}

uint8_t hal_clock_stamps(void)
{
    return CLOCK_STAMPS(clock_counts());
}

uint16_t hal_clock_us(void)
{
    return CLOCK_US(clock_counts());
}
