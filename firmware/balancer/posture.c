#include "posture.h"

#define CALM PERIODS(0.5f)
#define CALM_RATE 0.035f                /* rad/s */
#define CALM_LEAN RAD(3.0f)
#define CALM_INNOVATION 0.05f           /* rad */
#define CALM_BIAS_VARIANCE 1.1e-4f      /* rad2/s2: the gyroscope's bias is known well enough */

#define STOP PERIODS(2.0f)              /* it sits down at the latest after so long, stopped or not */
#define REST_SPEED 0.05f                /* m/s */
#define REST_RATE 0.15f                 /* rad/s */
#define LEAN_OVER PERIODS(0.95f)        /* a lean that takes longer has met something */
/* Shortly before the caster touches the floor: torque against the caster throws it to the other side. */
#define LET_GO_LEAN RAD(10.5f)

struct fault_rule {
    uint8_t cause;
    bool goes_off;                      /* at once; else it sits down */
};

/* The first one that holds gives the cause. It sits down where it can do without what is lost. */
static const struct fault_rule rules[] = {
    { CAUSE_GYROSCOPE, true },
    { CAUSE_LIFTED, true },
    { CAUSE_LEAN_DISPUTED, true },
    { CAUSE_NO_WHEEL_TURNS, true },
    { CAUSE_FALLEN, true },
    { CAUSE_ACCELEROMETER, false },
    { CAUSE_LEFT_ENCODER, false },
    { CAUSE_RIGHT_ENCODER, false },
    { CAUSE_BATTERY, false },
};

static void enter(struct posture *p, uint8_t posture, uint8_t cause)
{
    if (p->posture == BALANCE_STANDS)
        p->cause = cause;               /* the first one since it stood */
    p->posture = posture;
    p->since = 0;
    p->leans_over = false;
}

static void off(struct posture *p, uint8_t cause)
{
    if (p->posture == BALANCE_OFF)
        return;
    enter(p, BALANCE_OFF, cause);
    p->still = 0;
    p->is_calm = false;
}

/* Where no side is free it goes off where it stands: it may stay upright on its friction. */
static void sit(struct posture *p, uint8_t cause, uint8_t side)
{
    if (p->posture != BALANCE_STANDS)
        return;
    if (side == SIDE_NONE) {
        off(p, cause);
        return;
    }
    enter(p, BALANCE_SITS_DOWN, cause);
    p->side = side;
}

static void follow_faults(struct posture *p, const struct posture_input *in)
{
    for (uint8_t k = 0; k < sizeof rules / sizeof *rules; k++) {
        if (!(in->faults & FAULT(rules[k].cause)))
            continue;
        if (rules[k].goes_off)
            off(p, rules[k].cause);
        else
            sit(p, rules[k].cause, in->order->free_side);
    }
}

static void sit_on(struct posture *p, const struct posture_input *in)
{
    const struct kalman *k = in->kalman;
    if (p->leans_over) {
        /* A lean that is no number has passed it, too. */
        if (!(magnitude(k->lean - in->trim) <= LET_GO_LEAN) || p->since > LEAN_OVER)
            off(p, p->cause);
        return;
    }
    if (in->order->free_side != SIDE_NONE)
        p->side = in->order->free_side;
    bool rests = magnitude(in->speed) < REST_SPEED && magnitude(k->rate) < REST_RATE;
    if (rests || p->since > STOP) {
        p->leans_over = true;
        p->since = 0;
    }
}

bool posture_step(struct posture *p, const struct posture_input *in)
{
    const struct balance_order *order = in->order;
    const struct kalman *k = in->kalman;
    bool calm = magnitude(k->rate) < CALM_RATE && magnitude(k->lean) < CALM_LEAN
                && magnitude(k->innovation) < CALM_INNOVATION && k->p11 < CALM_BIAS_VARIANCE && !in->faults;
    p->still = lasting(p->still, calm);
    p->is_calm = p->still > CALM;
    p->since = lasting(p->since, true);

    bool stood = p->posture != BALANCE_OFF;
    if (in->cord_pulled)
        off(p, CAUSE_CORD);
    if (order->off)
        off(p, order->off_cause);
    follow_faults(p, in);
    if (order->sits)
        sit(p, CAUSE_ASKED, order->free_side);
    if (p->posture == BALANCE_SITS_DOWN)
        sit_on(p, in);
    if (stood || p->posture != BALANCE_OFF)
        return false;
    if (!order->may_stand || order->sits || order->off || in->cord_pulled || !p->is_calm)
        return false;
    *p = (struct posture){ .posture = BALANCE_STANDS, .is_calm = true, .still = p->still };
    return true;
}
