/* The width of the servo pulse that stands for a level, from the constants of a board with such outputs. */
#ifndef GIRAFF_PULSE_H
#define GIRAFF_PULSE_H
#include <stdbool.h>
#include <stdint.h>
#include "board.h"

enum { PULSE_COUNTS_PER_US = 2, PULSE_NEUTRAL = PULSE_NEUTRAL_US * PULSE_COUNTS_PER_US };

/* counts: of 255, as of PWM; not 0. */
static inline uint16_t pulse_of(bool forward, uint8_t counts)
{
    const uint32_t reach_q8 = ((PULSE_SPAN_US - PULSE_DEAD_US) * PULSE_COUNTS_PER_US * 256ul + UINT8_MAX - 1) / UINT8_MAX;
    uint16_t beyond = (uint16_t)(PULSE_DEAD_US * PULSE_COUNTS_PER_US + (counts * reach_q8 >> 8));
    return (uint16_t)(forward ? PULSE_NEUTRAL + beyond : PULSE_NEUTRAL - beyond);
}

#endif
