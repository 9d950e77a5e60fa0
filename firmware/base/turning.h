/* Whether a wheel turns as its motor is told. Only policy: level and ticks come in as arguments. */
#ifndef GIRAFF_TURNS_H
#define GIRAFF_TURNS_H
#include <stdint.h>

enum turns { TURNS_AS_TOLD, TURNS_STUCK, TURNS_OPPOSITE };

struct turning {                /* of one wheel; all zero at first */
    int8_t direction;           /* of its level: 1, -1, or 0 for none */
    uint16_t left_at;           /* ticks it has since been within STUCK_EDGES of */
    uint16_t pushed_ms;         /* spent so at a level that turns every wheel */
    uint8_t slice_ms;           /* of the slice of time under way */
    uint16_t slice_ticks;       /* at its begin */
    uint16_t slowest;           /* fewest ticks against the level in any slice since the level has this direction */
    uint8_t against_ms;         /* turned against the level without slowing down */
};

/* Each millisecond: the level the motor gets, PWM counts, and the low half of the wheel's ticks, forward positive.
 * The level must be none for a millisecond before and after a time in which nobody judges. */
enum turns turning_judge(struct turning *t, int16_t level, uint8_t stall_level, uint16_t ticks);

#endif
