#include "watch.h"

/* Each limit lies between the largest value of ten minutes among people and what the fault shows. */
#define GYROSCOPE_LOW 30.0f             /* counts, ends of what a healthy axis shows */
#define GYROSCOPE_HIGH 990.0f
#define ACCELEROMETER_LOW 150.0f        /* -3.5 and +3.5 g */
#define ACCELEROMETER_HIGH 870.0f
#define RAIL_S 0.009f                   /* two readings */
#define SAME_S 0.075f                   /* equal readings; without a fault up to 0.05 */
#define APART_S 0.02f
#define APART_MAX RAD(6.0f)             /* a second; without a fault up to 3.3 */
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
#define SILENT_S 0.1f                   /* without a fault up to 0.06 */

#define KEPT (FAULT(CAUSE_ACCELEROMETER) | FAULT(CAUSE_LEFT_ENCODER) | FAULT(CAUSE_RIGHT_ENCODER))

enum { AXIS_0, AXIS_1, FORWARD, UP, CHANNELS };

static const struct { float low, high; } scale[CHANNELS] = {
    [AXIS_0] = { GYROSCOPE_LOW, GYROSCOPE_HIGH },
    [AXIS_1] = { GYROSCOPE_LOW, GYROSCOPE_HIGH },
    [FORWARD] = { ACCELEROMETER_LOW, ACCELEROMETER_HIGH },
    [UP] = { ACCELEROMETER_LOW, ACCELEROMETER_HIGH },
};

static void watch_readings(struct watch *w, const struct balance_readings *r)
{
    const float now[CHANNELS] = { r->gyro[0], r->gyro[1], r->forward, r->up };
    for (uint8_t k = 0; k < CHANNELS; k++) {
        w->rail_s[k] = lasting(w->rail_s[k], now[k] < scale[k].low || now[k] > scale[k].high);
        w->same_s[k] = lasting(w->same_s[k], now[k] == w->last[k]);
        w->last[k] = now[k];
    }
}

/* An axis that is lost shows nothing while the other one shows the lean. Both show roll, as when one wheel goes over an
 * edge: the difference of what they show would take that for a fault, the difference of how much they show does not. */
static void watch_axes(struct watch *w, const struct watch_input *in)
{
    float own[2];
    for (uint8_t k = 0; k < 2; k++) {
        float axis = in->inertial->axis[k];
        w->zero[k] = followed(w->zero[k], axis - in->kalman->rate, in->is_off ? ZERO_OFF_S : ZERO_S);
        own[k] = magnitude(axis - w->zero[k]);
    }
    float apart = magnitude(own[0] - own[1]) - APART_GAIN * magnitude(in->kalman->rate);
    w->apart = followed(w->apart, apart, APART_S);
}

static bool either(const float seconds[2], float most)
{
    return seconds[0] > most || seconds[1] > most;
}

static void watch_encoders(struct watch *w, const struct watch_input *in)
{
    for (uint8_t k = 0; k < WHEELS; k++) {
        bool has_power = magnitude((float)in->command[k]) * in->inertial->volts > SILENT_VOLTS * DRIVER_FULL;
        w->silent_s[k] = lasting(w->silent_s[k], has_power && in->wheels->steps[k] == 0);
    }
}

void watch_step(struct watch *w, const struct watch_input *in)
{
    const struct kalman *k = in->kalman;
    watch_readings(w, in->readings);
    watch_axes(w, in);
    w->disputed = followed(w->disputed, k->innovation, LEAN_S);
    w->flat = followed(w->flat, k->measured, LEAN_S);
    w->slip = followed(w->slip, in->wheels->told - in->wheels->axle, SLIP_S);
    watch_encoders(w, in);

    uint16_t faults = 0;
    if (either(&w->rail_s[AXIS_0], RAIL_S) || either(&w->same_s[AXIS_0], SAME_S) || w->apart > APART_MAX)
        faults |= FAULT(CAUSE_GYROSCOPE);
    if (either(&w->rail_s[FORWARD], RAIL_S) || (w->same_s[FORWARD] > SAME_S && w->same_s[UP] > SAME_S))
        faults |= FAULT(CAUSE_ACCELEROMETER);
    if (in->inertial->volts < in->settings->volts_min)
        faults |= FAULT(CAUSE_BATTERY);
    if (!in->leans_over && magnitude(k->lean) > FALLEN_LEAN)
        faults |= FAULT(CAUSE_FALLEN);
    if (!is_prototype(in->settings)) {
        bool left = w->silent_s[LEFT] > SILENT_S, right = w->silent_s[RIGHT] > SILENT_S;
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
