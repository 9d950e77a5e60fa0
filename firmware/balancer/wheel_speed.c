#include "wheel_speed.h"

#define TRACK_PLACE 0.35f       /* shares of the tracking filter: the angle follows at once, */
#define TRACK_SPEED 0.06f       /* the speed within 25 ms */
#define ACCELERATION_S 0.15f    /* slow and never clipped: gears that chatter must not shift its mean */
#define FUSE_S 0.25f            /* a motor inside its gear's play runs free: the encoders correct the speed slowly */
#define BELIEVED_MAX 1.0f       /* m/s that a robot without encoders believes in: the motors give 1.08 */

void wheel_speed_count(struct wheel_speed *w, const struct model *model, const int32_t counts[WHEELS],
                       const bool lost[WHEELS])
{
    if (model->is_prototype)
        return;
    for (uint8_t k = 0; k < WHEELS; k++) {
        w->steps[k] = w->has_counts ? (int32_t)((uint32_t)counts[k] - (uint32_t)w->counts[k]) : 0;
        w->counts[k] = counts[k];
    }
    w->has_counts = true;
    float before = w->speed[LEFT] + w->speed[RIGHT];
    for (uint8_t k = 0; k < WHEELS; k++) {
        bool copies = lost[k] && !lost[1 - k];
        w->turned[k] = (float)w->steps[copies ? 1 - k : k] * model->settings.rad_per_count;
        w->lag[k] += w->turned[k] - w->speed[k] * PERIOD;
        w->speed[k] += TRACK_SPEED / PERIOD * w->lag[k];
        w->lag[k] *= 1.0f - TRACK_PLACE;
    }
    float now = w->speed[LEFT] + w->speed[RIGHT];
    w->acceleration = followed(w->acceleration, (now - before) * (0.5f / PERIOD), ACCELERATION_S);
}

float wheel_speed_acceleration(const struct wheel_speed *w, const struct model *model,
                               const struct kalman *k)
{
    return model->is_prototype ? model->acceleration_per_lean * k->lean : model->settings.radius * w->acceleration;
}

void wheel_speed_fuse(struct wheel_speed *w, const struct model *model, const struct kalman *k,
                      float forward, bool has_accelerometer)
{
    if (model->is_prototype) {          /* the integral of the lean: the I of the PID */
        w->axle = clipped(w->axle + model->acceleration_per_lean * PERIOD * k->lean, BELIEVED_MAX);
        return;
    }
    float leaned = k->lean - w->lean;
    w->lean = k->lean;
    w->turn = model->turn_per_rad * (w->speed[RIGHT] - w->speed[LEFT]);
    w->moved = model->half_radius * (w->turned[LEFT] + w->turned[RIGHT] + leaned + leaned);
    w->told = model->half_radius * (w->speed[LEFT] + w->speed[RIGHT] + k->rate + k->rate);
    if (has_accelerometer)
        w->axle += GRAVITY * PERIOD * (forward + k->lean * (1.0f - k->lean * k->lean * (1.0f / 6.0f)));
    else
        w->axle += model->settings.radius * PERIOD * w->acceleration;
    w->axle = followed(w->axle, w->told, FUSE_S);
}
