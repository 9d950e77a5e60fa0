/* How fast a wheel turns, from its edges and the time between them. Only policy: all comes in as arguments. */
#ifndef GIRAFF_SPEEDOMETER_H
#define GIRAFF_SPEEDOMETER_H
#include <stdbool.h>
#include <stdint.h>
#include "protocol.h"

enum { SPEEDOMETER_SPAN = 4 };      /* periods with an edge that a speed is the mean of */

struct speedometer {                /* of one wheel; all zero at first */
    struct seen {
        uint16_t ticks;             /* after a period that had an edge, */
        uint16_t stamp;             /* the newest edge's time, */
        uint16_t now;               /* and the time until which edges were known */
    } seen[SPEEDOMETER_SPAN];
    uint8_t newest, n;              /* in seen: where, and how many before it */
    uint16_t now;                   /* stamp of the last call */
    uint16_t silent;                /* stamps since the newest edge; stays at the largest */
    uint16_t between_stamps;        /* between the newest two edges: so long for each of so many ticks; 0 = not known */
    uint16_t between_ticks;
    bool is_overdue;                /* the next edge should have come: OVERDUE_INTERVALS and OVERDUE_MS are over; or
                                     * too few have come, or those that came led nowhere */
    int32_t um_s;                   /* forward positive */
};

/* Each SPEED_PERIOD_MS. ticks: low half of the wheel's count. stamp: when the newest edge came; now: the time, both in
 * STAMPS_PER_MS, and wrapping. um_per_tick_q8: way of the rim for a tick, in 1/256 um. */
void speedometer_step(struct speedometer *s, uint32_t um_per_tick_q8, uint16_t ticks, uint16_t stamp, uint16_t now);

#endif
