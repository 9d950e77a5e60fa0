#include <stdbool.h>
#include "board.h"
#include "drive.h"
#include "freshness.h"
#include "hal.h"
#include "latch.h"
#include "limit.h"
#include "speed.h"
#include "turning.h"

enum { MOTORS = 2, WIRING_BITS = 2 * WIRING_INVERT_RIGHT_ENCODER - 1 };

/* Shared with the millisecond interrupt: these change together or not at all. */
static volatile uint8_t state = DRIVE_NOT_CONFIGURED;
static volatile uint16_t time_left_ms;          /* until the command time-out, while active */
static volatile int16_t level[MOTORS];
static volatile int32_t asked_um_s[WHEELS];
static uint8_t wiring;                          /* of the session, as are the next two */
static uint8_t stall_level;
static struct speed_settings speed_settings;
static volatile uint16_t battery_adc_counts;

/* Of the millisecond interrupt. */
static struct speed_control control;
static uint8_t speed_due_ms;
static uint8_t rest_q8[WHEELS];                 /* of the PWM that whole counts have not given yet */
static uint8_t held_age_ms;                     /* of DRIVE_HELD; the largest = longer */
static uint16_t held_ago[HELD_TIMES - 1];       /* periods since a wheel was held, the newest first; 0 = never */

/* Of the session. */
static uint32_t session;                        /* 0 = none since the boot */
static uint8_t level_max;
static uint32_t speed_max;
static bool has_last_seq;
static uint16_t last_seq;

/* Since the boot. */
static uint8_t last_refusal = REFUSAL_NONE;
static uint16_t accepted, refused;
static bool is_limited;                         /* the newest accepted command, by the board's own limit */

/* A latch outlasts every other reason not to drive. */
static void stop(enum drive_state why)
{
    state = latch_cause() == LATCH_NONE ? why : DRIVE_LATCHED;
    for (uint8_t motor = 0; motor < MOTORS; motor++)
        level[motor] = 0;
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++)
        asked_um_s[wheel] = 0;
    speed_stop(&control);
}

/* A session is driven by levels or by speeds. */
static enum refusal judge_configure(
    const struct configure *asked, struct speed_settings *settings, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->protocol_hash != PROTOCOL_HASH)
        return REFUSAL_PROTOCOL;
    if (!asked->session || !asked->stall_level || asked->wiring & ~WIRING_BITS)
        return REFUSAL_PROTOCOL;
    if (!asked->level_max == !asked->speed_max_um_s || !speed_configure(settings, asked))
        return REFUSAL_PROTOCOL;
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms))
        return REFUSAL_STALE;
    return REFUSAL_NONE;
}

/* What drives: a frame of levels, or one of speeds. */
struct command {
    uint16_t seq;
    uint32_t boot_id, board_ms;
    int16_t level[WHEELS];
    int32_t um_s[WHEELS];
};

static enum refusal judge_command(const struct command *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms))
        return REFUSAL_STALE;
    if (!session)
        return REFUSAL_NOT_CONFIGURED;
    if (has_last_seq && !is_newer(asked->seq, last_seq))
        return REFUSAL_SEQUENCE;
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        if (!is_within(asked->level[wheel], level_max) || !is_within(asked->um_s[wheel], speed_max))
            return REFUSAL_LEVEL;
    }
    return REFUSAL_NONE;
}

/* Besides, it must be younger than the latch: one made before it releases something else. */
static enum refusal judge_release(const struct estop *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms) || now_ms - asked->board_ms >= latch_age_ms())
        return REFUSAL_STALE;
    if (!session || asked->session != session)
        return REFUSAL_NOT_CONFIGURED;
    return REFUSAL_NONE;
}

static void refuse(enum refusal why)
{
    last_refusal = (uint8_t)why;
    refused++;
}

void drive_start(void)
{
    latch_start();
    stop(DRIVE_NOT_CONFIGURED);
}

void drive_on_configure(const struct configure *asked, uint32_t boot_id, uint32_t now_ms)
{
    struct speed_settings settings;
    enum refusal refusal = judge_configure(asked, &settings, boot_id, now_ms);
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    ATOMICALLY {
        stop(DRIVE_AWAITING_ZERO);
        wiring = asked->wiring;
        stall_level = asked->stall_level;
        speed_settings = settings;
        speed_forget_wheels(&control);
    }
    session = asked->session;
    level_max = asked->level_max;
    speed_max = asked->speed_max_um_s;
    has_last_seq = false;
}

/* What the board's own limit leaves of a command; whether that is less. */
static bool lower(struct command *asked)
{
    int32_t values[WHEELS];
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++)
        values[wheel] = level_max ? asked->level[wheel] : asked->um_s[wheel];
    bool lowered = limit_lower(values, level_max ? level_max : speed_max);
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        if (level_max)
            asked->level[wheel] = (int16_t)values[wheel];
        else
            asked->um_s[wheel] = values[wheel];
    }
    return lowered;
}

static void obey(struct command *asked, uint32_t boot_id, uint32_t now_ms)
{
    enum refusal refusal = judge_command(asked, boot_id, now_ms);
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    /* Taken whatever becomes of it: a host uses up all numbers within 11 minutes, and a latch may last longer. */
    has_last_seq = true;
    last_seq = asked->seq;
    bool opens = !asked->level[LEFT] && !asked->level[RIGHT] && !asked->um_s[LEFT] && !asked->um_s[RIGHT];
    bool limited = HAS_LEVEL_LIMIT && lower(asked);
    ATOMICALLY {        /* the interrupt may stop the motors up to here, and is looked at here */
        if (state == DRIVE_LATCHED) {
            refusal = REFUSAL_LATCHED;
        } else if (state == DRIVE_HELD && now_ms - asked->board_ms + 1 >= held_age_ms) {
            refusal = REFUSAL_AWAITING_ZERO;    /* of a host that cannot know yet; now_ms may be of a moment ago */
        } else if (!opens && state != DRIVE_ACTIVE) {
            refusal = REFUSAL_AWAITING_ZERO;
        } else {
            state = DRIVE_ACTIVE;
            time_left_ms = COMMAND_TIMEOUT_MS;
            for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
                asked_um_s[wheel] = asked->um_s[wheel];
                if (level_max)
                    level[wiring_motor(wiring, wheel)] = wiring_level(wiring, wheel, asked->level[wheel]);
            }
        }
    }
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    accepted++;
    if (HAS_LEVEL_LIMIT)
        is_limited = limited;
}

void drive_on_levels(const struct drive *asked, uint32_t boot_id, uint32_t now_ms)
{
    struct command command = {
        .seq = asked->seq,
        .boot_id = asked->boot_id,
        .board_ms = asked->board_ms,
        .level = { asked->left_level, asked->right_level },
    };
    obey(&command, boot_id, now_ms);
}

void drive_on_speeds(const struct speed *asked, uint32_t boot_id, uint32_t now_ms)
{
    struct command command = {
        .seq = asked->seq,
        .boot_id = asked->boot_id,
        .board_ms = asked->board_ms,
        .um_s = { asked->left_um_s, asked->right_um_s },
    };
    obey(&command, boot_id, now_ms);
}

/* Who releases has looked at what held a wheel. */
static void forget_held(void)
{
    for (uint8_t i = 0; i < HELD_TIMES - 1; i++)
        held_ago[i] = 0;
}

void drive_on_estop(const struct estop *asked, uint32_t boot_id, uint32_t now_ms)
{
    enum refusal refusal = REFUSAL_NONE;
    ATOMICALLY {        /* what latches now is not what the host wants released */
        if (asked->engage) {
            latch_engage(LATCH_ESTOP);
            stop(DRIVE_LATCHED);
        } else {
            refusal = judge_release(asked, boot_id, now_ms);
            if (refusal == REFUSAL_NONE && state == DRIVE_LATCHED) {
                latch_release();
                stop(DRIVE_AWAITING_ZERO);
                forget_held();
            }
        }
    }
    if (refusal != REFUSAL_NONE)
        refuse(refusal);
}

static void judge_wheel(enum wheel wheel, uint16_t ticks)
{
    static struct turning turning[MOTORS];
    int16_t given = wiring_level(wiring, wheel, level[wiring_motor(wiring, wheel)]);
    switch (turning_judge(&turning[wheel], given, stall_level, ticks)) {
    case TURNS_STUCK:
        latch_engage(wheel == LEFT ? LATCH_LEFT_STUCK : LATCH_RIGHT_STUCK);
        break;
    case TURNS_OPPOSITE:
        latch_engage(wheel == LEFT ? LATCH_LEFT_OPPOSITE : LATCH_RIGHT_OPPOSITE);
        break;
    default:
        return;
    }
    stop(DRIVE_LATCHED);
}

/* Whoever is held again and again is not to be pushed again and again. */
static void stop_held(void)
{
    const uint16_t within = HELD_WITHIN_MS / SPEED_PERIOD_MS;
    uint8_t oldest = HELD_TIMES - 2;
    if (held_ago[oldest] && held_ago[oldest] <= within)
        latch_engage(control.flags & SPEED_LEFT_HELD ? LATCH_LEFT_STUCK : LATCH_RIGHT_STUCK);
    for (uint8_t i = oldest; i > 0; i--)
        held_ago[i] = held_ago[i - 1];
    held_ago[0] = 1;
    held_age_ms = 0;
    stop(DRIVE_HELD);
}

static void on_speed_period(const uint16_t ticks[WHEELS], const uint16_t stamps[WHEELS], uint16_t now)
{
    struct speed_input in = { .now = now, .battery_adc_counts = battery_adc_counts };
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        in.asked_um_s[wheel] = asked_um_s[wheel];
        in.ticks[wheel] = ticks[wheel];
        in.stamps[wheel] = stamps[wheel];
    }
    for (uint8_t i = 0; i < HELD_TIMES - 1; i++) {
        if (held_ago[i] && held_ago[i] < UINT16_MAX)
            held_ago[i]++;
    }
    if (speed_step(&control, &speed_settings, &in))
        stop_held();
}

/* A count of PWM is 9 mm/s: its parts are given in turn, millisecond by millisecond. */
static void give_speed_pwm(enum wheel wheel)
{
    int32_t pwm_q8 = control.wheel[wheel].pwm_q8;
    uint16_t sum_q8 = (uint16_t)((pwm_q8 < 0 ? -pwm_q8 : pwm_q8) + rest_q8[wheel]);
    int16_t whole = (int16_t)(sum_q8 / 256);
    rest_q8[wheel] = pwm_q8 ? (uint8_t)sum_q8 : 0;
    level[wiring_motor(wiring, wheel)] = wiring_level(wiring, wheel, pwm_q8 < 0 ? -whole : whole);
}

void drive_on_millisecond(const struct encoders_edge newest[2], uint16_t now_stamp)
{
    latch_on_millisecond();
    if (HAS_LEVEL_LIMIT)
        limit_on_millisecond(state == DRIVE_ACTIVE);
    if (held_age_ms < UINT8_MAX)
        held_age_ms++;
    if (state == DRIVE_ACTIVE && --time_left_ms == 0)
        stop(DRIVE_COMMAND_TIMEOUT);
    uint16_t ticks[WHEELS], stamps[WHEELS];
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        const struct encoders_edge *edge = &newest[wiring_encoder(wiring, wheel)];
        ticks[wheel] = (uint16_t)wiring_ticks(wiring, wheel, edge->ticks);
        stamps[wheel] = edge->stamp;
    }
    if (++speed_due_ms >= SPEED_PERIOD_MS) {
        speed_due_ms = 0;
        on_speed_period(ticks, stamps, now_stamp);
    }
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        if (speed_max) {
            speed_on_asked(&control, wheel, asked_um_s[wheel]);
            give_speed_pwm(wheel);
        }
        judge_wheel(wheel, ticks[wheel]);
    }
}

int16_t drive_level(uint8_t motor)
{
    return level[motor];
}

void drive_on_battery(uint16_t adc_counts)
{
    ATOMICALLY {
        battery_adc_counts = adc_counts;
    }
}

struct drive_report drive_report(void)
{
    struct drive_report report = {
        .session = session,
        .last_refusal = last_refusal,
        .accepted = accepted,
        .refused = refused,
    };
    ATOMICALLY {
        report.drive_state = state;
        report.latch = (uint8_t)latch_cause();
        report.speed_flags = control.flags;
        if (HAS_LEVEL_LIMIT && is_limited && state == DRIVE_ACTIVE)
            report.speed_flags |= SPEED_AT_LIMIT;
        for (uint8_t wheel = 0; wheel < WHEELS; wheel++)
            report.um_s[wheel] = control.wheel[wheel].speedometer.um_s;
    }
    return report;
}

uint8_t drive_wiring(void)
{
    return wiring;
}
