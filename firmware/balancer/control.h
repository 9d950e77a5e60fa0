/* What the modules of the control loop share. The processor has no float unit: a sum or a product takes it 130 cycles,
 * a division 500, and a period has 80,000. What follows from the settings alone is computed once. Times are counted in
 * periods. A bound costs one comparison. What is slow is computed in every second period: the correction of the filter
 * in one, the rest in the other.
 */
#ifndef GIRAFF_CONTROL_H
#define GIRAFF_CONTROL_H
#include "balance.h"

#define PERIOD (BALANCE_PERIOD_MS * 0.001f)     /* s */
#define SLOW_PERIOD (2.0f * PERIOD)
#define PERIODS(seconds) ((uint16_t)((seconds) / PERIOD + 0.5f))
#define GRAVITY 9.81f                           /* m/s2 */
#define RAD(degrees) ((degrees) * 0.0174532925f)

enum { LEFT, RIGHT, WHEELS };

struct model {
    struct balance_settings settings;
    bool is_prototype;                  /* it balances by its lean alone, and has no encoders */
    float per_radius;                   /* 1/m */
    float half_radius;                  /* m */
    float half_track;                   /* m */
    float turn_per_rad;                 /* rad of the robot for each rad by which a wheel turns more */
    float lean_per_acceleration;        /* rad for each m/s2 */
    float acceleration_per_lean;        /* m/s2 of a robot that leans by a rad and does not fall */
    float lean_per_speed;               /* rad of lean that give it a m/s in two periods, */
    float lean_per_rate;                /* or a rad/s */
    float volts_per_torque;             /* of a motor that stands */
    float acceleration_step, braking_step;      /* m/s in a period */
};

static inline float magnitude(float value)
{
    return __builtin_fabsf(value);
}

static inline float clipped(float value, float most)
{
    return magnitude(value) <= most ? value : __builtin_copysignf(most, value);
}

/* Mean that follows `value` within `seconds`. */
static inline float followed(float mean, float value, float seconds)
{
    return mean + PERIOD / seconds * (value - mean);
}

/* The same, in every second period. */
static inline float followed_slowly(float mean, float value, float seconds)
{
    return mean + SLOW_PERIOD / seconds * (value - mean);
}

/* Periods for which `holds` has been true. */
static inline uint16_t lasting(uint16_t periods, bool holds)
{
    return !holds ? 0 : periods < UINT16_MAX ? periods + 1 : periods;
}

#endif
