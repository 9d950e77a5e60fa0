/* What is wrong with the sensors, the motors and the posture. Each fault is a bit: 1 << enum balance_cause. */
#ifndef GIRAFF_WATCH_H
#define GIRAFF_WATCH_H
#include "control.h"
#include "inertial.h"
#include "kalman.h"
#include "wheel_speed.h"

#define FAULT(cause) ((uint16_t)(1u << (cause)))

struct watch {
    float last[CHANNELS];               /* counts of the last period */
    uint16_t rail[CHANNELS];            /* periods off the scale, */
    uint16_t same[CHANNELS];            /* or equal to the last one */
    float zero[2];                      /* rad/s that each axis of the gyroscope shows at rest */
    float apart;                        /* rad/s by which one axis turns more than the other */
    float disputed;                     /* rad by which accelerometer and filter differ */
    float flat;                         /* rad: lean by the accelerometer */
    float slip;                         /* m/s by which encoders and fused speed differ */
    uint16_t silent[WHEELS];            /* periods without a count although the motor has power */
    uint16_t idle[WHEELS];              /* periods without a count although the robot turns to and fro */
    uint16_t faults;                    /* now */
    uint16_t kept;                      /* since it stood up, of the sensors that it goes on without */
};

struct watch_input {
    const struct balance_readings *readings;
    const struct model *model;
    const struct inertial *inertial;
    const struct kalman *kalman;
    const struct wheel_speed *wheels;
    const int8_t *command;              /* of the last period */
    bool is_off;
    bool sways;                         /* of reference.h */
    bool is_second;                     /* of two periods */
    bool leans_over;                    /* on purpose, to sit down */
};

void watch_step(struct watch *w, const struct watch_input *in);

#endif
