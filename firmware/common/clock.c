#include "clock.h"
#include "hal.h"
#include "start_values.h"

static volatile uint32_t ms;
static volatile uint16_t stamp;     /* at the last millisecond */
static volatile uint32_t us;        /* at the last millisecond: counted, since ms * 1000 would wrap elsewhere */

void clock_start(void)
{
    ms = start_values.board_ms;
    us = start_values.board_us;
    hal_start_clock();
}

void clock_on_millisecond(void)
{
    ms++;
    us += 1000;
    stamp += CLOCK_STAMPS_PER_MS;
}

uint32_t clock_ms(void)
{
    uint32_t now;
    ATOMICALLY {
        now = ms;
    }
    return now;
}

uint32_t clock_us(void)
{
    uint32_t now;
    ATOMICALLY {
        now = us + hal_clock_us();
    }
    return now;
}

uint16_t clock_stamp(void)
{
    return (uint16_t)(stamp + hal_clock_stamps());
}

uint16_t clock_stamp_after(uint16_t counts)
{
    return (uint16_t)(stamp + CLOCK_STAMPS(counts));
}

uint32_t clock_us_after(uint16_t later_us)
{
    return us + later_us;
}

bool clock_due(uint32_t *last_ms, uint16_t period_ms)
{
    if (clock_ms() - *last_ms < period_ms)
        return false;
    *last_ms += period_ms;
    return true;
}
