#include "gathered.h"
#include "board.h"
#include "clock.h"
#include "encoders.h"
#include "hal.h"
#include "hal_base.h"
#include "start_values.h"

/* From so many edges in a millisecond on, other interrupts may make some read B too late: it then changes 31 us after A,
 * of which they take up to 16. Fewer are counted one by one, since a wheel that rattles may well reverse among them. */
enum { MANY = 16 };

volatile struct gathered gathered[2];

static volatile struct encoders_reading reading;    /* at the last millisecond */
static volatile uint8_t readings;                   /* so many, to tell a new one from it; wraps */
static volatile uint16_t stamps[2];

void encoders_start(void)
{
    reading.counts[0] = reading.counts[1] = start_values.ticks;
    hal_start_encoders();
}

/* No wheel that turns so fast reverses within the millisecond: where three of four edges have one direction, all have
 * it. A wheel that trembles on an edge has as many of either, and stands. */
static int16_t ticks_of(const struct gathered *taken)
{
    uint8_t edges = taken->edges, forward = taken->forward, backward = (uint8_t)(edges - forward);
    if (edges >= MANY && forward <= edges / 4)
        forward = 0, backward = edges;
    else if (edges >= MANY && backward <= edges / 4)
        forward = edges, backward = 0;
    return (int16_t)(forward - backward);
}

/* The clock has not counted this millisecond yet. */
void encoders_on_millisecond(void)
{
    struct gathered taken[2];
    for (uint8_t encoder = 0; encoder < 2; encoder++) {
        volatile struct gathered *from = &gathered[encoder];
        taken[encoder] = (struct gathered){ from->edges, from->forward, from->at, from->ended };
        from->edges = from->forward = 0;
    }
    uint16_t later_us = hal_clock_us();
    hal_enable_interrupts();        /* the next edges do not wait for the rest, of which they touch nothing */
    for (uint8_t encoder = 0; encoder < 2; encoder++) {
        const struct gathered *new = &taken[encoder];
        if (!new->edges)
            continue;
        reading.counts[encoder] += (uint32_t)(int32_t)ticks_of(new);
        bool ended = new->ended && new->at < CLOCK_COUNTS_PER_MS / 2;   /* and not just after it was read */
        stamps[encoder] = (uint16_t)(clock_stamp_after(new->at) + (ended ? CLOCK_STAMPS_PER_MS : 0));
    }
    reading.at_us = clock_us_after((uint16_t)(1000 + later_us));
    readings++;
}

/* From the millisecond interrupt, which alone changes what it reads. */
struct encoders_edge encoders_newest(uint8_t encoder)
{
    return (struct encoders_edge){ .ticks = (uint16_t)reading.counts[encoder], .stamp = stamps[encoder] };
}

/* Interrupts stay on: an edge that waits for this, and for the other encoder's, would meet its next one. */
struct encoders_reading encoders_read(void)
{
    struct encoders_reading read;
    uint8_t seen;
    do {
        seen = readings;
        read = reading;
    } while (seen != readings);
    return read;
}

/* For a processor whose interrupts take no time. */
static void on_edge(uint8_t encoder, bool a, bool b)
{
    uint16_t counts = hal_clock_us() / CLOCK_US(1);
    gathered_on_edge(encoder, a, b, (uint8_t)(counts % CLOCK_COUNTS_PER_MS), counts >= CLOCK_COUNTS_PER_MS);
}

void encoders_on_edge_0(bool a, bool b)
{
    on_edge(0, a, b);
}

void encoders_on_edge_1(bool a, bool b)
{
    on_edge(1, a, b);
}

uint16_t encoders_until(void)
{
    return clock_stamp();
}
