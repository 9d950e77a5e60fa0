#include "clock.h"
#include "encoders.h"
#include "hal.h"
#include "hal_base.h"
#include "start_values.h"

static volatile uint32_t counts[2];     /* unsigned: they wrap */

void encoders_start(void)
{
    counts[0] = counts[1] = start_values.ticks;
    hal_start_encoders();
}

void encoders_on_edge_0(bool a, bool b)
{
    if (a != b)
        counts[0]++;
    else
        counts[0]--;
}

void encoders_on_edge_1(bool a, bool b)
{
    if (a == b)
        counts[1]++;
    else
        counts[1]--;
}

uint16_t encoders_low(uint8_t encoder)
{
    uint16_t low;
    ATOMICALLY {
        low = (uint16_t)counts[encoder];
    }
    return low;
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
