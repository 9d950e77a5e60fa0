#include "watch.h"

/* Each limit lies between the largest value of ten minutes among people and what the fault shows. */
#define RAIL PERIODS(0.01f)             /* two readings */
#define SAME PERIODS(0.075f)            /* equal readings; without a fault up to 0.05 s */
#define APART_S 0.02f
#define APART_MAX RAD(6.0f)             /* a second; without a fault up to 3.9 */
#define APART_GAIN 0.12f                /* of the rate: the axes' gains differ by that much */
#define ZERO_OFF_S 0.25f                /* in which it learns each axis's zero while it is off */
#define ZERO_S 10.0f                    /* and else: they warm up */
#define LEAN_S 0.5f
#define DISPUTED_MAX RAD(8.0f)          /* without a fault up to 3.1 */
#define FLAT_MAX RAD(14.0f)             /* without a fault up to 9.0 */
#define FALLEN_LEAN RAD(11.0f)
#define SLIP_S 0.05f
#define SLIP_MAX 0.35f                  /* m/s; without a fault up to 0.17 */
#define SILENT_VOLTS 2.0f               /* by which a motor surely turns */
#define SILENT PERIODS(0.1f)            /* without a fault up to 0.06 s */

#define IDLE PERIODS(1.7f)              /* without a fault up to 0.75 s */

#define KEPT (FAULT(CAUSE_ACCELEROMETER) | FAULT(CAUSE_LEFT_ENCODER) | FAULT(CAUSE_RIGHT_ENCODER))

static void watch_readings(struct watch *w, const struct watch_input *in)
{
    const struct balance_readings *r = in->readings;
    const float now[CHANNELS] = { r->gyro[0], r->gyro[1], r->forward, r->up };
    for (uint8_t k = 0; k < CHANNELS; k++) {
        w->rail[k] = lasting(w->rail[k], in->inertial->off_scale[k]);
        w->same[k] = lasting(w->same[k], now[k] == w->last[k]);
        w->last[k] = now[k];
    }
}

/* A lost axis shows nothing while the other one shows the lean. Both show roll, with opposite signs. Of a robot that
 * leans and turns the encoders tell the roll. When one wheel goes over an edge the axes differ in sign, not in size, so
 * their sizes are compared. */
static void watch_axes(struct watch *w, const struct watch_input *in)
{
    float roll = in->wheels->turn * in->kalman->lean, own[2];
    for (uint8_t k = 0; k < 2; k++) {
        float axis = k == AXIS_0 ? in->inertial->axis[k] + roll : in->inertial->axis[k] - roll;
        if (in->is_second)
            w->zero[k] = followed_slowly(w->zero[k], axis - in->kalman->rate, in->is_off ? ZERO_OFF_S : ZERO_S);
        own[k] = magnitude(axis - w->zero[k]);
    }
    float apart = magnitude(own[0] - own[1]) - APART_GAIN * magnitude(in->kalman->rate);
    w->apart = followed(w->apart, apart, APART_S);
}

static bool either(const uint16_t periods[2], uint16_t most)
{
    return periods[0] >= most || periods[1] >= most;
}

static void watch_encoders(struct watch *w, const struct watch_input *in)
{
    for (uint8_t k = 0; k < WHEELS; k++) {
        bool is_silent = in->wheels->steps[k] == 0
                         && magnitude((float)in->command[k]) * in->inertial->volts > SILENT_VOLTS * DRIVER_FULL;
        w->silent[k] = lasting(w->silent[k], is_silent);
        w->idle[k] = lasting(w->idle[k], in->sways && !in->is_off && in->wheels->steps[k] == 0);
    }
}

static bool is_lost(const struct watch *w, uint8_t wheel)
{
    return w->silent[wheel] >= SILENT || w->idle[wheel] >= IDLE;
}

void watch_step(struct watch *w, const struct watch_input *in)
{
    const struct kalman *k = in->kalman;
    watch_readings(w, in);
    watch_axes(w, in);
    if (in->is_second) {
        w->disputed = followed_slowly(w->disputed, k->innovation, LEAN_S);
        w->flat = followed_slowly(w->flat, k->measured, LEAN_S);
    }
    w->slip = followed(w->slip, in->wheels->told - in->wheels->axle, SLIP_S);
    watch_encoders(w, in);

    uint16_t faults = 0;
    if (either(&w->rail[AXIS_0], RAIL) || either(&w->same[AXIS_0], SAME) || w->apart > APART_MAX)
        faults |= FAULT(CAUSE_GYROSCOPE);
    if (either(&w->rail[FORWARD], RAIL) || (w->same[FORWARD] >= SAME && w->same[UP] >= SAME))
        faults |= FAULT(CAUSE_ACCELEROMETER);
    if (in->inertial->volts < in->model->settings.volts_min)
        faults |= FAULT(CAUSE_BATTERY);
    if (!in->leans_over && !(magnitude(k->lean) <= FALLEN_LEAN))        /* a lean that is no number has fallen, too */
        faults |= FAULT(CAUSE_FALLEN);
    if (!in->model->is_prototype) {
        bool left = is_lost(w, LEFT), right = is_lost(w, RIGHT);
        if (left && right)
            faults |= FAULT(CAUSE_NO_WHEEL_TURNS);
        else if (left)
            faults |= FAULT(CAUSE_LEFT_ENCODER);
        else if (right)
            faults |= FAULT(CAUSE_RIGHT_ENCODER);
        if (magnitude(w->slip) > SLIP_MAX)
            faults |= FAULT(CAUSE_LIFTED);
    }
    /* What the accelerometer says counts while it is trusted. */
    w->kept = in->is_off ? 0 : w->kept | (faults & KEPT);
    if (!(w->kept & FAULT(CAUSE_ACCELEROMETER))
        && (magnitude(w->disputed) > DISPUTED_MAX || magnitude(w->flat) > FLAT_MAX))
        faults |= FAULT(CAUSE_LEAN_DISPUTED);
    w->faults = faults;
}
