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
    const struct balance_settings *settings = in->settings;
    const struct reference *r = in->reference;
    float lean_per_acceleration = settings->momentum_per_speed / settings->gravity;
    float lean = in->kalman->lean - r->trim - lean_per_acceleration * r->acceleration;
    float torque = settings->k1 * lean + settings->k2 * in->kalman->rate + settings->k3 * r->ahead
                   + settings->k4 * clipped(in->wheels->axle - r->speed, SPEED_ERROR_MAX);
    if (in->posture->posture == BALANCE_STANDS && !is_prototype(settings)) {
        t->slope = clipped(t->slope + clipped(torque, SLOPE_MAX) * (PERIOD / SLOPE_S), SLOPE_MAX);
        torque += t->slope;
    }
    return torque;
}

/* It lets itself down to the side: the lean that it holds grows from the one at which it stands. */
static float leaning_over(const struct torque_input *in)
{
    const struct balance_settings *settings = in->settings;
    float part = in->posture->since_s * (1.0f / SIT_S);
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
    float speed = wheel_speed_turn(in->wheels, in->settings);
    float torque = TURN_PLACE * clipped(r->turn_behind, TURN_ERROR_MAX) + TURN_SPEED * (r->turn - speed);
    return clipped(torque, TURN_MAX);
}

/* Share of the battery that gives a motor its torque against friction and back-EMF. */
static float share(const struct torque_input *in, float torque, float side)
{
    const struct balance_settings *settings = in->settings;
    const struct reference *r = in->reference;
    float speed = in->wheels->axle + side * 0.5f * settings->track * r->turn;
    float turns = speed / settings->radius - in->kalman->rate;      /* the motor against the chassis, rad/s */
    float friction = FRICTION_SHARE * settings->friction
                     * clipped(turns * (1.0f / FRICTION_SPEED) + torque * (1.0f / FRICTION_TORQUE), 1.0f);
    float emf = is_prototype(settings) ? EMF_SHARE_PROTOTYPE : EMF_SHARE;
    float against = emf * turns + (1.0f - EMF_SHARE) * r->speed / settings->radius;
    float amperes = (torque + friction) / settings->motor_constant;
    float volts = settings->motor_ohm * amperes + settings->motor_constant * against;
    return volts / (in->volts > VOLTS_LOW ? in->volts : VOLTS_LOW);
}

void torque_step(struct torque *t, const struct torque_input *in)
{
    if (in->posture->posture == BALANCE_OFF) {
        *t = (struct torque){ 0 };
        return;
    }
    float asked = in->posture->leans_over ? leaning_over(in) : standing(t, in);
    t->both = clipped(asked, in->settings->torque_max);
    float turn = turning(in);
    float left = share(in, t->both * 0.5f - turn, -1.0f), right = share(in, t->both * 0.5f + turn, 1.0f);
    float both = clipped((left + right) * 0.5f, 1.0f);
    float half = clipped((right - left) * 0.5f, 1.0f - magnitude(both));    /* standing comes before turning */
    t->is_at_limit = magnitude(asked) > in->settings->torque_max || magnitude(both) >= 1.0f;
    for (uint8_t k = 0; k < WHEELS; k++) {
        float exact = (both + (k == RIGHT ? half : -half)) * DRIVER_FULL + t->rest[k];
        t->command[k] = (int8_t)lrintf(clipped(exact, DRIVER_FULL));
        t->rest[k] = clipped(exact - (float)t->command[k], 1.0f);
    }
}
