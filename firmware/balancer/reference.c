#include "reference.h"

#define ACCELERATION_S 0.0625f          /* the lean for a changed speed comes softly */
/* In which it comes to a larger speed. The body leans forward to speed up, and the wheels must run ahead to raise it:
 * after a ramp that ends at once, the robot is faster by 0.2 m/s for a moment. */
#define APPROACH_S 0.8f
#define TURN_BEHIND_MAX 3.0f            /* rad: more is no more astray */

/* An obstacle holds it: a wheel has much less than the speed that it is asked for, or it turns astray. */
#define SLOW_ASKED 0.1f                 /* m/s */
#define SLOW_SHARE 0.3f
#define SLOW PERIODS(1.3f)
#define ASTRAY 0.35f                    /* rad */
#define ASTRAY_FOR PERIODS(0.3f)

/* A robot that stands sits inside its gear play: its encoders, its motors and the line to them could be lost unseen. */
#define SWAY_TURN 0.15f                 /* rad/s: less does not always overcome the friction */
#define SWAY PERIODS(0.5f)              /* to each side: it turns by two degrees at most */

/* How the trim is learned. */
#define UNEXPLAINED_S 0.1f
#define TRIM_STEP RAD(2.0f)             /* more is a push, not a shifted zero, and is hardly learned */
#define TRIM_MAX RAD(7.0f)
#define TRIM_S 4.0f
#define TRIM_FIRST_S 2.0f               /* a robot that has just stood up learns its zero */
#define TRIM_BACK_S 1.0f                /* back to the usual one: the shift was a push */
#define TRIM_PLACE RAD(0.1f)            /* a second, for a place that is a leash away */
#define FIRST PERIODS(6.0f)
#define USUAL_S 20.0f
#define USUAL_FIRST_S 2.0f

void reference_start(struct reference *r)
{
    *r = (struct reference){ .momentum = r->momentum, .unexplained = r->unexplained, .halts = r->halts };
}

/* Here, at once, and without a lean: a ramp takes as long, and at its end the robot still leans back and rolls back. */
static void stop(struct reference *r)
{
    if (r->speed != 0.0f)
        r->ahead = 0.0f;
    r->speed = 0.0f;
    r->acceleration = 0.0f;
}

void reference_halt(struct reference *r)
{
    stop(r);
    r->ahead = 0.0f;
    r->turn_behind = 0.0f;
}

static bool is_slow(const struct reference *r, const struct reference_input *in)
{
    float turn = r->turn * in->model->half_track;
    float turns = in->wheels->turn * in->model->half_track;
    for (uint8_t k = 0; k < WHEELS; k++) {
        float asked = k == RIGHT ? r->speed + turn : r->speed - turn;
        if (magnitude(asked) <= SLOW_ASKED)
            continue;
        float does = k == RIGHT ? in->wheels->axle + turns : in->wheels->axle - turns;
        if ((asked > 0.0f ? does : -does) < SLOW_SHARE * magnitude(asked))
            return true;
    }
    return false;
}

static void watch_obstacle(struct reference *r, const struct reference_input *in)
{
    r->slow = lasting(r->slow, is_slow(r, in));
    r->astray = lasting(r->astray, magnitude(r->turn_behind) > ASTRAY);
    if (r->slow > SLOW || r->astray > ASTRAY_FOR)
        r->is_held = true;
    bool is_zero = magnitude(in->order->linear) <= 0.0f && magnitude(in->order->angular) <= 0.0f;
    if (!in->order->halts && (r->halts || is_zero))
        r->is_held = false;
}

static void follow_speed(struct reference *r, const struct reference_input *in, float asked)
{
    if (asked == 0.0f) {
        stop(r);
        return;
    }
    bool slower = (asked < 0.0f) != (r->speed < 0.0f) || magnitude(asked) < magnitude(r->speed);
    float most = slower && r->speed != 0.0f ? in->model->braking_step : in->model->acceleration_step;
    float left = asked - r->speed;
    float change = clipped(slower ? left : left * (PERIOD / APPROACH_S), most);
    r->speed += change;
    r->acceleration = followed(r->acceleration, change * (1.0f / PERIOD), ACCELERATION_S);
}

/* A sensor's zero, a slope or a bag shifts the lean at which it stands. Gravity changes the momentum about the point
 * where the wheels touch the floor. The part that gravity does not explain shows the error of the trim. */
static void learn_trim(struct reference *r, const struct reference_input *in)
{
    if (in->model->is_prototype || !in->is_second)
        return;
    float momentum = in->model->lean_per_speed * in->wheels->axle + in->model->lean_per_rate * in->kalman->rate;
    float gained = momentum - r->momentum;
    r->momentum = momentum;
    r->unexplained = followed_slowly(r->unexplained, in->kalman->lean - r->trim - gained, UNEXPLAINED_S);
    if (!in->stands)
        return;
    bool is_new = in->since < FIRST;
    bool comes_back = (r->unexplained > 0.0f) == (r->usual > r->trim);
    float share = comes_back ? SLOW_PERIOD / TRIM_BACK_S : is_new ? SLOW_PERIOD / TRIM_FIRST_S : SLOW_PERIOD / TRIM_S;
    r->trim += share * clipped(r->unexplained, TRIM_STEP) - SLOW_PERIOD * TRIM_PLACE / LEASH * r->ahead;
    r->trim = clipped(r->trim, TRIM_MAX);
    r->usual = followed_slowly(r->usual, r->trim, is_new ? USUAL_FIRST_S : USUAL_S);
}

static float swayed(struct reference *r)
{
    r->sways_for = !r->sways ? SWAY / 2 : r->sways_for < 2 * SWAY ? r->sways_for + 1 : 0;
    return !r->sways ? 0.0f : r->sways_for < SWAY ? SWAY_TURN : -SWAY_TURN;
}

void reference_step(struct reference *r, const struct reference_input *in)
{
    const struct balance_settings *settings = &in->model->settings;
    watch_obstacle(r, in);
    bool drives = in->stands && !in->order->halts && !r->is_held && !in->model->is_prototype;
    if (in->order->halts && !r->halts)
        reference_halt(r);
    r->halts = in->order->halts;

    r->ahead += in->wheels->moved - r->speed * PERIOD;
    follow_speed(r, in, drives ? clipped(in->order->linear, settings->speed_max) : 0.0f);
    r->ahead = clipped(r->ahead, LEASH);

    float turned = in->model->turn_per_rad * (in->wheels->turned[RIGHT] - in->wheels->turned[LEFT]);
    r->turn = drives ? clipped(in->order->angular, settings->turn_max) : 0.0f;
    r->sways = in->stands && r->turn == 0.0f && r->speed == 0.0f && !in->model->is_prototype;
    r->turn += swayed(r);
    r->turn_behind = r->is_held ? 0.0f : clipped(r->turn_behind + r->turn * PERIOD - turned, TURN_BEHIND_MAX);
    learn_trim(r, in);
}
