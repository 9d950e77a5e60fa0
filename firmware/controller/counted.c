#include "counted.h"
#include "clock.h"
#include "encoders.h"
#include "duty.h"
#include "start_values.h"

static struct encoders_reading reading;
static uint16_t stamps[2], until;
static uint32_t before[2];
static bool is_known;

void encoders_start(void)
{
    reading.counts[0] = reading.counts[1] = start_values.ticks;
}

/* When the newest edge came is not known: at this reading at the latest, and after the one before it. */
void counted_on_reading(const uint32_t counters[2])
{
    until = clock_stamp();
    reading.at_us = clock_us();
    for (uint8_t encoder = 0; encoder < 2; encoder++) {
        uint32_t more = is_known ? counters[encoder] - before[encoder] : 0;
        reading.counts[encoder] += more;
        if (more)
            stamps[encoder] = until;
        before[encoder] = counters[encoder];
    }
    is_known = true;
}

void encoders_on_millisecond(void)
{
    duty_on_millisecond();
}

struct encoders_edge encoders_newest(uint8_t encoder)
{
    return (struct encoders_edge){ .ticks = (uint16_t)reading.counts[encoder], .stamp = stamps[encoder] };
}

struct encoders_reading encoders_read(void)
{
    return reading;
}

/* A reading that is late says nothing of a wheel: it may turn on. */
uint16_t encoders_until(void)
{
    return until;
}
