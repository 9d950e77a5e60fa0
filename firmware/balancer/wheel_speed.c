#include <math.h>
#include "wheel_speed.h"

#define TRACK_PLACE 0.35f       /* shares of the tracking filter: the angle follows at once, */
#define TRACK_SPEED 0.06f       /* the speed within 25 ms */
#define ACCELERATION_S 0.15f    /* slow and never clipped: gears that chatter must not shift its mean */
#define FUSE_S 0.25f            /* a motor inside its gear's play runs free: the encoders correct the speed slowly */
#define BELIEVED_MAX 1.0f       /* m/s that a robot without encoders believes in: the motors give 1.08 */

void wheel_speed_count(struct wheel_speed *w, const struct balance_settings *settings, const int32_t counts[WHEELS],
                       const bool lost[WHEELS])
{
    for (uint8_t k = 0; k < WHEELS; k++) {
        w->steps[k] = w->has_counts ? (int32_t)((uint32_t)counts[k] - (uint32_t)w->counts[k]) : 0;
        w->counts[k] = counts[k];
    }
    w->has_counts = true;
    float before = w->speed[LEFT] + w->speed[RIGHT];
    for (uint8_t k = 0; k < WHEELS; k++) {
        bool copies = lost[k] && !lost[1 - k];
        w->turned[k] = (float)w->steps[copies ? 1 - k : k] * settings->rad_per_count;
        w->lag[k] += w->turned[k] - w->speed[k] * PERIOD;
        w->speed[k] += TRACK_SPEED / PERIOD * w->lag[k];
        w->lag[k] -= TRACK_PLACE * w->lag[k];
    }
    float now = w->speed[LEFT] + w->speed[RIGHT];
    w->acceleration = followed(w->acceleration, (now - before) * (0.5f / PERIOD), ACCELERATION_S);
}

/* m/s2 of a robot that leans so and does not fall: gravity alone changes its momentum about the point where the wheels
 * touch the floor. */
static float acceleration_by_lean(const struct balance_settings *settings, const struct kalman *k)
{
    return settings->gravity / settings->momentum_per_speed * k->lean;
}

float wheel_speed_acceleration(const struct wheel_speed *w, const struct balance_settings *settings,
                               const struct kalman *k)
{
    return is_prototype(settings) ? acceleration_by_lean(settings, k) : settings->radius * w->acceleration;
}

void wheel_speed_fuse(struct wheel_speed *w, const struct balance_settings *settings, const struct kalman *k,
                      float forward, bool has_accelerometer)
{
    float leaned = k->lean - w->lean;
    w->moved = settings->radius * ((w->turned[LEFT] + w->turned[RIGHT]) * 0.5f + leaned);
    w->told = settings->radius * ((w->speed[LEFT] + w->speed[RIGHT]) * 0.5f + k->rate);
    if (is_prototype(settings)) {
        w->moved = 0.0f;
        w->axle = clipped(w->axle + acceleration_by_lean(settings, k) * PERIOD, BELIEVED_MAX);
        w->told = w->axle;              /* the integral of the lean: the I of the PID */
    } else {
        float downhill = sinf(k->lean);
        float felt = has_accelerometer ? GRAVITY * (forward + downhill) : settings->radius * w->acceleration;
        w->axle = followed(w->axle + felt * PERIOD, w->told, FUSE_S);
    }
    w->lean = k->lean;
}

float wheel_speed_turn(const struct wheel_speed *w, const struct balance_settings *settings)
{
    return settings->radius * (w->speed[RIGHT] - w->speed[LEFT]) / settings->track;
}
