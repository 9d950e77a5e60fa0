/* What the modules of the control loop share. */
#ifndef GIRAFF_CONTROL_H
#define GIRAFF_CONTROL_H
#include "balance.h"

#define PERIOD (BALANCE_PERIOD_MS * 0.001f)     /* s */
#define GRAVITY 9.81f                           /* m/s2 */
#define RAD(degrees) ((degrees) * 0.0174532925f)

enum { LEFT, RIGHT, WHEELS };

static inline float clipped(float value, float most)
{
    return value > most ? most : value < -most ? -most : value;
}

static inline float magnitude(float value)
{
    return value < 0.0f ? -value : value;
}

/* Mean that follows `value` within `seconds`. */
static inline float followed(float mean, float value, float seconds)
{
    return mean + PERIOD / seconds * (value - mean);
}

/* s for which `holds` has been true. It stays small enough to count on. */
static inline float lasting(float seconds, bool holds)
{
    return !holds ? 0.0f : seconds < 60.0f ? seconds + PERIOD : seconds;
}

/* Without the terms of place and speed it balances by its lean alone, and has no encoders. */
static inline bool is_prototype(const struct balance_settings *settings)
{
    return settings->k3 <= 0.0f && settings->k4 <= 0.0f;
}

#endif
