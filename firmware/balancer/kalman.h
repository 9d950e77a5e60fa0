/* Lean and the gyroscope's bias, by a Kalman filter of these two states. Equations only. */
#ifndef GIRAFF_KALMAN_H
#define GIRAFF_KALMAN_H
#include <stdbool.h>

struct kalman {
    float lean, bias;                   /* rad, rad/s */
    float rate;                         /* rad/s, without the bias */
    float forward, up;                  /* g, smoothed */
    float measured;                     /* rad: lean by the accelerometer alone */
    float innovation;                   /* rad: that less the lean */
    float p00, p01, p11;                /* covariance of lean and bias */
};

struct kalman_input {
    float rate;                         /* rad/s, of the gyroscope */
    float forward, up;                  /* g, of the accelerometer */
    float axle;                         /* m/s2: the axle's own acceleration, by the encoders */
    bool corrects;                      /* by the accelerometer: in every second period, if there is one */
};

void kalman_start(struct kalman *k);
void kalman_step(struct kalman *k, const struct kalman_input *in);

#endif
