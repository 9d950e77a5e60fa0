#include "reference.h"

#define ACCELERATION_S 0.0625f          /* the lean for a changed speed comes softly */
#define TURN_BEHIND_MAX 3.0f            /* rad: more is no more astray */

/* An obstacle holds it: a wheel has much less than the speed that it is asked for, or it turns astray. */
#define SLOW_ASKED 0.1f                 /* m/s */
#define SLOW_SHARE 0.3f
#define SLOW_S 1.3f
#define ASTRAY 0.35f                    /* rad */
#define ASTRAY_S 0.3f

/* How the trim is learned. */
#define UNEXPLAINED_S 0.1f
#define TRIM_STEP RAD(2.0f)             /* more is a push, not a shifted zero, and is hardly learned */
#define TRIM_MAX RAD(7.0f)
#define TRIM_S 4.0f
#define TRIM_FIRST_S 2.0f               /* a robot that has just stood up learns its zero */
#define TRIM_BACK_S 1.0f                /* back to the usual one: the shift was a push */
#define TRIM_PLACE RAD(0.1f)            /* a second, for a place that is a leash away */
#define FIRST_S 6.0f
#define USUAL_S 20.0f
#define USUAL_FIRST_S 2.0f

void reference_start(struct reference *r)
{
    *r = (struct reference){ .momentum = r->momentum, .unexplained = r->unexplained, .halts = r->halts };
}

/* Here, at once, and without a lean: a ramp takes as long, and at its end the robot still leans back and rolls back. */
static void stop(struct reference *r)
{
    r->speed = 0.0f;
    r->acceleration = 0.0f;
    r->ahead = 0.0f;
}

void reference_halt(struct reference *r)
{
    stop(r);
    r->turn_behind = 0.0f;
}

static bool is_slow(const struct reference *r, const struct reference_input *in)
{
    const struct balance_settings *settings = in->settings;
    const struct wheel_speed *w = in->wheels;
    for (uint8_t k = 0; k < WHEELS; k++) {
        float asked = r->speed + (k == RIGHT ? 0.5f : -0.5f) * settings->track * r->turn;
        float does = w->axle + (w->speed[k] - w->speed[1 - k]) * settings->radius * 0.5f;
        if (magnitude(asked) > SLOW_ASKED && (asked > 0.0f ? does : -does) < SLOW_SHARE * magnitude(asked))
            return true;
    }
    return false;
}

static void watch_obstacle(struct reference *r, const struct reference_input *in)
{
    r->slow_s = lasting(r->slow_s, is_slow(r, in));
    r->astray_s = lasting(r->astray_s, magnitude(r->turn_behind) > ASTRAY);
    if (r->slow_s > SLOW_S || r->astray_s > ASTRAY_S)
        r->is_held = true;
    bool is_zero = magnitude(in->order->linear) <= 0.0f && magnitude(in->order->angular) <= 0.0f;
    if (!in->order->halts && (r->halts || is_zero))
        r->is_held = false;
}

static void follow_speed(struct reference *r, const struct reference_input *in, float asked)
{
    const struct balance_settings *settings = in->settings;
    if (magnitude(asked) <= 0.0f) {
        if (magnitude(r->speed) > 0.0f)
            stop(r);
        r->acceleration = followed(r->acceleration, 0.0f, ACCELERATION_S);
        return;
    }
    bool slower = asked * r->speed < 0.0f || magnitude(asked) < magnitude(r->speed);
    float most = (slower ? settings->braking : settings->acceleration) * PERIOD;
    float change = clipped(asked - r->speed, most);
    r->speed += change;
    r->acceleration = followed(r->acceleration, change * (1.0f / PERIOD), ACCELERATION_S);
}

/* A sensor's zero, a slope or a bag shifts the lean at which it stands. Gravity changes the momentum about the point
 * where the wheels touch the floor. The part that gravity does not explain shows the error of the trim. */
static void learn_trim(struct reference *r, const struct reference_input *in)
{
    const struct balance_settings *settings = in->settings;
    float momentum = settings->momentum_per_speed * in->wheels->axle + settings->momentum_per_rate * in->kalman->rate;
    float gained = (momentum - r->momentum) / (settings->gravity * PERIOD);
    r->momentum = momentum;
    r->unexplained = followed(r->unexplained, in->kalman->lean - r->trim - gained, UNEXPLAINED_S);
    if (!in->stands || is_prototype(settings))
        return;
    bool is_new = in->since_s < FIRST_S;
    bool comes_back = r->unexplained * (r->usual - r->trim) > 0.0f;
    float seconds = comes_back ? TRIM_BACK_S : is_new ? TRIM_FIRST_S : TRIM_S;
    float place = clipped(r->ahead * (1.0f / LEASH), 1.0f) * TRIM_PLACE;
    r->trim += (clipped(r->unexplained, TRIM_STEP) / seconds - place) * PERIOD;
    r->trim = clipped(r->trim, TRIM_MAX);
    r->usual = followed(r->usual, r->trim, is_new ? USUAL_FIRST_S : USUAL_S);
}

void reference_step(struct reference *r, const struct reference_input *in)
{
    const struct balance_settings *settings = in->settings;
    watch_obstacle(r, in);
    bool drives = in->stands && !in->order->halts && !r->is_held && !is_prototype(settings);
    if (in->order->halts && !r->halts)
        reference_halt(r);
    r->halts = in->order->halts;

    r->ahead += in->wheels->moved - r->speed * PERIOD;
    follow_speed(r, in, drives ? clipped(in->order->linear, settings->speed_max) : 0.0f);
    r->ahead = clipped(r->ahead, LEASH);

    float turned = settings->radius * (in->wheels->turned[RIGHT] - in->wheels->turned[LEFT]) / settings->track;
    r->turn = drives ? clipped(in->order->angular, settings->turn_max) : 0.0f;
    r->turn_behind = r->is_held ? 0.0f : clipped(r->turn_behind + r->turn * PERIOD - turned, TURN_BEHIND_MAX);
    learn_trim(r, in);
}
