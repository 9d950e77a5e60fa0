#include "clock.h"
#include "encoders.h"
#include "hal.h"
#include "hal_base.h"
#include "start_values.h"

static volatile uint32_t counts[2];     /* unsigned: they wrap */
static volatile uint16_t stamps[2];

void encoders_start(void)
{
    counts[0] = counts[1] = start_values.ticks;
    hal_start_encoders();
}

void encoders_on_edge_0(bool a, bool b)
{
    stamps[0] = clock_stamp();
    if (a != b)
        counts[0]++;
    else
        counts[0]--;
}

void encoders_on_edge_1(bool a, bool b)
{
    stamps[1] = clock_stamp();
    if (a == b)
        counts[1]++;
    else
        counts[1]--;
}

void encoders_on_millisecond(void)
{
    /* Each edge has been counted as it came. */
}

struct encoders_edge encoders_newest(uint8_t encoder)
{
    struct encoders_edge newest;
    ATOMICALLY {
        newest.ticks = (uint16_t)counts[encoder];
        newest.stamp = stamps[encoder];
    }
    return newest;
}

struct encoders_reading encoders_read(void)
{
    struct encoders_reading read;
    ATOMICALLY {
        read.at_us = clock_us();
        read.counts[0] = counts[0];
        read.counts[1] = counts[1];
    }
    return read;
}

uint16_t encoders_until(void)
{
    return clock_stamp();
}
