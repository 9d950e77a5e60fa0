/* Which motor and which encoder a wheel has, and which way round: configure.wiring, applied.
 * Unsigned arithmetic throughout, since counts wrap. */
#ifndef GIRAFF_WIRING_H
#define GIRAFF_WIRING_H
#include <stdint.h>
#include "protocol.h"

enum wheel { LEFT = 0, RIGHT = 1 };

static inline uint8_t wiring_motor(uint8_t wiring, enum wheel wheel)
{
    return (uint8_t)(wheel ^ ((wiring & WIRING_SWAP_MOTORS) ? 1 : 0));
}

static inline uint8_t wiring_encoder(uint8_t wiring, enum wheel wheel)
{
    return (uint8_t)(wheel ^ ((wiring & WIRING_SWAP_ENCODERS) ? 1 : 0));
}

/* A level of the wheel as one of its motor, or the other way round. */
static inline int16_t wiring_level(uint8_t wiring, enum wheel wheel, int16_t level)
{
    uint8_t invert = wheel == LEFT ? WIRING_INVERT_LEFT_MOTOR : WIRING_INVERT_RIGHT_MOTOR;
    return (wiring & invert) ? (int16_t)-level : level;
}

static inline int32_t wiring_ticks(uint8_t wiring, enum wheel wheel, uint32_t count)
{
    uint8_t invert = wheel == LEFT ? WIRING_INVERT_LEFT_ENCODER : WIRING_INVERT_RIGHT_ENCODER;
    return (int32_t)((wiring & invert) ? 0 - count : count);
}

#endif
