#include <math.h>
#include "torque.h"

#define SPEED_ERROR_MAX 0.4f            /* m/s that count: catching a push takes no more */
#define SLOPE_MAX 8.0f                  /* N m */
#define SLOPE_S 3.0f
#define SIT_LEAN RAD(14.0f)             /* beyond the lean at which it lets go */
#define SIT_S 0.8f

#define TURN_ERROR_MAX 0.2f             /* rad that count */
#define TURN_PLACE 25.0f                /* N m for each rad */
#define TURN_SPEED 8.0f                 /* N m s for each rad */
#define TURN_MAX 8.0f                   /* N m of each motor */

#define FRICTION_SHARE 0.8f             /* that is compensated: more than there is would shake it */
#define FRICTION_SPEED 0.15f            /* rad/s at which the whole friction acts against it, */
#define FRICTION_TORQUE 3.0f            /* or N m asked from rest */
#define EMF_SHARE 0.85f                 /* that follows the measured speed: all of it would shake the gears */
#define EMF_SHARE_PROTOTYPE 2.5f        /* of the integral of the lean: with less a push runs away from it */
#define VOLTS_LOW 6.0f                  /* a battery that cannot be: no command grows beyond it */

/* The four terms. Those of place and speed are bounded, not their sum: a bound on the sum makes it fall. */
static float standing(struct torque *t, const struct torque_input *in)
{
    const struct balance_settings *settings = &in->model->settings;
    const struct reference *r = in->reference;
    float lean = in->kalman->lean - r->trim - in->model->lean_per_acceleration * r->acceleration;
    float torque = settings->k1 * lean + settings->k2 * in->kalman->rate + settings->k3 * r->ahead
                   + settings->k4 * clipped(in->wheels->axle - r->speed, SPEED_ERROR_MAX);
    if (in->posture->posture == BALANCE_STANDS && !in->model->is_prototype) {
        t->slope = clipped(t->slope + clipped(torque, SLOPE_MAX) * (PERIOD / SLOPE_S), SLOPE_MAX);
        torque += t->slope;
    }
    return torque;
}

/* It lets itself down to the side: the lean that it holds grows from the one at which it stands. */
static float leaning_over(const struct torque_input *in)
{
    const struct balance_settings *settings = &in->model->settings;
    float part = (float)in->posture->since * (PERIOD / SIT_S);
    if (part > 1.0f)
        part = 1.0f;
    float most = in->posture->side == SIDE_FORWARD ? SIT_LEAN : -SIT_LEAN;
    float lean = most * part * part * (3.0f - 2.0f * part);
    float rate = most * (6.0f / SIT_S) * part * (1.0f - part);
    return settings->k1 * (in->kalman->lean - in->reference->trim - lean) + settings->k2 * (in->kalman->rate - rate);
}

static float turning(const struct torque_input *in)
{
    if (!in->has_encoders)
        return 0.0f;
    const struct reference *r = in->reference;
    float torque = TURN_PLACE * clipped(r->turn_behind, TURN_ERROR_MAX) + TURN_SPEED * (r->turn - in->wheels->turn);
    return clipped(torque, TURN_MAX);
}

/* Volts that give a motor its torque against friction and back-EMF. speed: wanted of its wheel, m/s. */
static float motor_volts(const struct torque_input *in, float torque, float speed)
{
    const struct model *model = in->model;
    float turns = speed * model->per_radius - in->kalman->rate;     /* the motor against the chassis, rad/s */
    float against = clipped(turns * (1.0f / FRICTION_SPEED) + torque * (1.0f / FRICTION_TORQUE), 1.0f);
    float emf = (model->is_prototype ? EMF_SHARE_PROTOTYPE : EMF_SHARE) * turns;
    if (in->reference->speed != 0.0f)
        emf += (1.0f - EMF_SHARE) * model->per_radius * in->reference->speed;
    return model->volts_per_torque * (torque + FRICTION_SHARE * model->settings.friction * against)
           + model->settings.motor_constant * emf;
}

void torque_step(struct torque *t, const struct torque_input *in)
{
    if (in->posture->posture == BALANCE_OFF) {
        *t = (struct torque){ 0 };
        return;
    }
    float asked = in->posture->leans_over ? leaning_over(in) : standing(t, in);
    t->both = clipped(asked, in->model->settings.torque_max);
    float each = t->both * 0.5f, turn = turning(in);
    float aside = in->model->half_track * in->reference->turn;
    float left = motor_volts(in, each - turn, in->wheels->axle - aside);
    float right = motor_volts(in, each + turn, in->wheels->axle + aside);
    float half_full = 0.5f * DRIVER_FULL / (in->volts > VOLTS_LOW ? in->volts : VOLTS_LOW);
    float both = clipped((right + left) * half_full, DRIVER_FULL);
    float apart = clipped((right - left) * half_full, DRIVER_FULL - magnitude(both));   /* standing before turning */
    t->is_at_limit = magnitude(asked) > in->model->settings.torque_max || magnitude(both) >= DRIVER_FULL;
    for (uint8_t k = 0; k < WHEELS; k++) {
        float exact = (k == RIGHT ? both + apart : both - apart) + t->rest[k];
        t->command[k] = (int8_t)lrintf(clipped(exact, DRIVER_FULL));
        t->rest[k] = clipped(exact - (float)t->command[k], 1.0f);
    }
}
