#include <math.h>
#include "control.h"
#include "kalman.h"

/* Found in simulation, on 40 drawn robots. */
#define LEAN_NOISE 3e-6f        /* rad2/s, by which the lean wanders beside the gyroscope */
#define BIAS_NOISE 3e-8f        /* rad2/s3, by which the bias wanders: it warms up for three minutes */
#define MEASURED_SD 0.03f       /* rad, of the accelerometer's lean at rest */
#define SD_PER_G 1.0f           /* rad for each g by which the accelerometer feels more than gravity */
#define AXLE_SHARE 0.5f         /* of the axle's acceleration that counts as such: what is subtracted is not exact */
#define SMOOTHING 0.1f          /* s. Gears that chatter shall neither shift the mean nor take away its weight. */
#define LEAN_SD_START 0.1f      /* rad */
#define SERIES_MAX 0.4f
#define BIAS_SD_START 0.06f     /* rad/s: two axes with 3 deg/s each */

void kalman_start(struct kalman *k)
{
    *k = (struct kalman){
        .up = 1.0f,
        .p00 = LEAN_SD_START * LEAN_SD_START,
        .p11 = BIAS_SD_START * BIAS_SD_START,
    };
}

/* atan2 costs as much as thirty products: a series is within 0.02 degrees where the robot balances. */
static float angle(float across, float along)
{
    if (magnitude(across) >= SERIES_MAX * along)
        return atan2f(across, along);
    float ratio = across / along, square = ratio * ratio;
    return ratio * (1.0f - square * (1.0f / 3.0f - square * (1.0f / 5.0f)));
}

void kalman_step(struct kalman *k, const struct kalman_input *in)
{
    k->forward = followed(k->forward, in->forward, SMOOTHING);
    k->up = followed(k->up, in->up, SMOOTHING);

    /* Predict: the lean grows by the rate, the bias stays. */
    k->rate = in->rate - k->bias;
    k->lean += k->rate * PERIOD;
    if (!in->corrects)
        return;

    /* The accelerometer also feels the axle's own acceleration. What the encoders know of it is subtracted. */
    float axle = in->axle * (1.0f / GRAVITY);
    k->measured = angle(axle - k->forward, k->up);
    k->innovation = k->measured - k->lean;
    k->p00 += SLOW_PERIOD * (SLOW_PERIOD * k->p11 - 2.0f * k->p01 + LEAN_NOISE);
    k->p01 -= SLOW_PERIOD * k->p11;
    k->p11 += BIAS_NOISE * SLOW_PERIOD;

    /* Update. What remains widens the noise, so that a push or a bump has little weight. */
    float square = k->forward * k->forward + k->up * k->up;
    float strange = 0.5f * magnitude(square - 1.0f) + AXLE_SHARE * magnitude(axle);     /* near 1 g half its square's */
    /* The variance of one measurement; two periods have half of it. */
    float variance = MEASURED_SD * MEASURED_SD + SD_PER_G * SD_PER_G * strange * strange;
    float share = 1.0f / (k->p00 + 0.5f * variance);
    float lean_gain = k->p00 * share, bias_gain = k->p01 * share;
    k->lean += lean_gain * k->innovation;
    k->bias += bias_gain * k->innovation;
    k->p11 -= bias_gain * k->p01;
    k->p01 -= lean_gain * k->p01;
    k->p00 -= lean_gain * k->p00;
}
