/* How the wheels turn and how fast the axle moves, from the encoders, the lean and the accelerometer. */
#ifndef GIRAFF_WHEEL_SPEED_H
#define GIRAFF_WHEEL_SPEED_H
#include "control.h"
#include "kalman.h"

struct wheel_speed {
    bool has_counts;
    int32_t counts[WHEELS];             /* of the last period */
    int32_t steps[WHEELS];              /* counts in this period: 0 of an encoder that is silent */
    float turned[WHEELS];               /* rad in this period, of the motor against the chassis */
    float speed[WHEELS];                /* rad/s of the same */
    float lag[WHEELS];                  /* rad by which the tracking filter is behind */
    float acceleration;                 /* rad/s2 of both, a slow mean */
    float lean;                         /* rad, of the last period */
    float turn;                         /* rad/s of the robot, to the left */
    float moved;                        /* m in this period, of the axle */
    float told;                         /* m/s of the axle by the encoders alone */
    float axle;                         /* m/s of the axle */
};

/* lost: of the encoder with that number. A lost one turns as the other one does. */
void wheel_speed_count(struct wheel_speed *w, const struct model *model, const int32_t counts[WHEELS],
                       const bool lost[WHEELS]);
/* forward: of the accelerometer, g. */
void wheel_speed_fuse(struct wheel_speed *w, const struct model *model, const struct kalman *k,
                      float forward, bool has_accelerometer);
/* m/s2 of the axle, for the filter of the lean. */
float wheel_speed_acceleration(const struct wheel_speed *w, const struct model *model,
                               const struct kalman *k);

#endif
