/* From lean and references to the motor driver's commands. */
#ifndef GIRAFF_TORQUE_H
#define GIRAFF_TORQUE_H
#include "control.h"
#include "kalman.h"
#include "posture.h"
#include "reference.h"
#include "wheel_speed.h"

struct torque {
    float both;                         /* N m of both motors, at the wheels */
    float slope;                        /* N m of these that hold it on a slope */
    bool is_at_limit;
    float rest[WHEELS];                 /* of a command, lost by rounding: the next period makes up for it */
    int8_t command[WHEELS];             /* of DRIVER_FULL */
};

struct torque_input {
    const struct model *model;
    const struct kalman *kalman;
    const struct wheel_speed *wheels;
    const struct reference *reference;
    const struct posture *posture;
    float volts;
    bool has_encoders;                  /* both */
};

void torque_step(struct torque *t, const struct torque_input *in);

#endif
