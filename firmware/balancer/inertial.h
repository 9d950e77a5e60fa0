/* Gyroscope, accelerometer and battery in their units. A reading off the scale leaves the last good one. */
#ifndef GIRAFF_INERTIAL_H
#define GIRAFF_INERTIAL_H
#include "balance.h"

enum { AXIS_0, AXIS_1, FORWARD, UP, CHANNELS };

struct inertial {
    bool off_scale[CHANNELS];
    float good[CHANNELS];               /* counts */
    float axis[2];                      /* rad/s of lean by each axis of the gyroscope, and of roll: +, - */
    float rate;                         /* rad/s of lean by both: roll cancels out */
    float forward, up;                  /* g */
    float volts;                        /* of the battery, smoothed */
};

void inertial_start(struct inertial *i);
void inertial_step(struct inertial *i, const struct balance_readings *readings);

#endif
