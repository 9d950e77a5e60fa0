#include "control.h"
#include "inertial.h"

/* IDG300 and ADXL330 at an AREF of 3.3 V. */
#define GYROSCOPE_ZERO 471.0f           /* counts */
#define GYROSCOPE_RAD_S RAD(1.611f)     /* for each count */
#define GYROSCOPE_SHARE 0.70710678f     /* of the lean in each axis: they lie at 45 degrees to the axle */
#define ACCELEROMETER_ZERO 512.0f       /* counts */
#define ACCELEROMETER_G 102.0f          /* counts for each g */
#define VOLTS_S 0.05f                   /* a motor that starts shall not look like an empty battery */
#define VOLTS_START 12.0f

/* Counts beyond which a reading says nothing. */
static const struct { float low, high; } scale[CHANNELS] = {
    [AXIS_0] = { 30.0f, 990.0f },
    [AXIS_1] = { 30.0f, 990.0f },
    [FORWARD] = { 150.0f, 870.0f },     /* -3.5 and +3.5 g */
    [UP] = { 150.0f, 870.0f },
};

void inertial_start(struct inertial *i)
{
    *i = (struct inertial){
        .good = { GYROSCOPE_ZERO, GYROSCOPE_ZERO, ACCELEROMETER_ZERO, ACCELEROMETER_ZERO + ACCELEROMETER_G },
        .volts = VOLTS_START,
    };
}

void inertial_step(struct inertial *i, const struct balance_readings *readings)
{
    const float now[CHANNELS] = { readings->gyro[0], readings->gyro[1], readings->forward, readings->up };
    for (uint8_t k = 0; k < CHANNELS; k++) {
        i->off_scale[k] = now[k] < scale[k].low || now[k] > scale[k].high;
        if (!i->off_scale[k])
            i->good[k] = now[k];
    }
    for (uint8_t k = 0; k < 2; k++)
        i->axis[k] = (i->good[k] - GYROSCOPE_ZERO) * (GYROSCOPE_RAD_S / GYROSCOPE_SHARE);
    i->rate = (i->axis[0] + i->axis[1]) * 0.5f;
    i->forward = (i->good[FORWARD] - ACCELEROMETER_ZERO) * (1.0f / ACCELEROMETER_G);
    i->up = (i->good[UP] - ACCELEROMETER_ZERO) * (1.0f / ACCELEROMETER_G);
    i->volts = followed(i->volts, readings->volts, VOLTS_S);
}
