#include <stdbool.h>
#include "drive.h"
#include "hal.h"
#include "latch.h"
#include "turning.h"

enum { MOTORS = 2, WIRING_BITS = 2 * WIRING_INVERT_RIGHT_ENCODER - 1 };

/* Shared with the millisecond interrupt: these change together or not at all. */
static volatile uint8_t state = DRIVE_NOT_CONFIGURED;
static volatile uint16_t time_left_ms;          /* until the command time-out, while active */
static volatile int16_t level[MOTORS];
static uint8_t wiring;                          /* of the session, as is the next */
static uint8_t stall_level;

/* Of the session. */
static uint32_t session;                        /* 0 = none since the boot */
static uint8_t level_max;
static bool has_last_seq;
static uint16_t last_seq;

/* Since the boot. */
static uint8_t last_refusal = REFUSAL_NONE;
static uint16_t accepted, refused;

/* Whether the host made the frame from telemetry old enough to matter. A time ahead of the board's is no better
 * than an old one: it comes out as a large age here. */
static bool is_stale(uint32_t echoed_ms, uint32_t now_ms)
{
    return now_ms - echoed_ms > ECHO_MAX_AGE_MS;
}

static bool is_newer(uint16_t seq, uint16_t than)
{
    uint16_t ahead = (uint16_t)(seq - than);
    return ahead && ahead < 0x8000;
}

static bool is_within(int16_t asked, uint8_t max)
{
    return asked >= -(int16_t)max && asked <= (int16_t)max;
}

/* A latch outlasts every other reason not to drive. */
static void stop(enum drive_state why)
{
    state = latch_cause() == LATCH_NONE ? why : DRIVE_LATCHED;
    for (uint8_t motor = 0; motor < MOTORS; motor++)
        level[motor] = 0;
}

static enum refusal judge_configure(const struct configure *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->protocol_hash != PROTOCOL_HASH)
        return REFUSAL_PROTOCOL;
    if (!asked->session || !asked->level_max || !asked->stall_level || asked->wiring & ~WIRING_BITS)
        return REFUSAL_PROTOCOL;
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms))
        return REFUSAL_STALE;
    return REFUSAL_NONE;
}

static enum refusal judge_drive(const struct drive *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms))
        return REFUSAL_STALE;
    if (!session)
        return REFUSAL_NOT_CONFIGURED;
    if (has_last_seq && !is_newer(asked->seq, last_seq))
        return REFUSAL_SEQUENCE;
    if (!is_within(asked->left_level, level_max) || !is_within(asked->right_level, level_max))
        return REFUSAL_LEVEL;
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
    enum refusal refusal = judge_configure(asked, boot_id, now_ms);
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    ATOMICALLY {
        stop(DRIVE_AWAITING_ZERO);
        wiring = asked->wiring;
        stall_level = asked->stall_level;
    }
    session = asked->session;
    level_max = asked->level_max;
    has_last_seq = false;
}

void drive_on_command(const struct drive *asked, uint32_t boot_id, uint32_t now_ms)
{
    enum refusal refusal = judge_drive(asked, boot_id, now_ms);
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    /* Taken whatever becomes of it: a host uses up all numbers within 11 minutes, and a latch may last longer. */
    has_last_seq = true;
    last_seq = asked->seq;
    int16_t left = wiring_level(wiring, LEFT, asked->left_level);
    int16_t right = wiring_level(wiring, RIGHT, asked->right_level);
    bool opens = !left && !right;
    ATOMICALLY {        /* the interrupt may stop the motors up to here, and is looked at here */
        if (state == DRIVE_LATCHED) {
            refusal = REFUSAL_LATCHED;
        } else if (!opens && state != DRIVE_ACTIVE) {
            refusal = REFUSAL_AWAITING_ZERO;
        } else {
            state = DRIVE_ACTIVE;
            time_left_ms = COMMAND_TIMEOUT_MS;
            level[wiring_motor(wiring, LEFT)] = left;
            level[wiring_motor(wiring, RIGHT)] = right;
        }
    }
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    accepted++;
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
            }
        }
    }
    if (refusal != REFUSAL_NONE)
        refuse(refusal);
}

static void judge_wheel(enum wheel wheel, const uint16_t ticks[2])
{
    static struct turning turning[MOTORS];
    int16_t given = wiring_level(wiring, wheel, level[wiring_motor(wiring, wheel)]);
    uint16_t turned = (uint16_t)wiring_ticks(wiring, wheel, ticks[wiring_encoder(wiring, wheel)]);
    switch (turning_judge(&turning[wheel], given, stall_level, turned)) {
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

void drive_on_millisecond(const uint16_t ticks[2])
{
    latch_on_millisecond();
    if (state == DRIVE_ACTIVE && --time_left_ms == 0)
        stop(DRIVE_COMMAND_TIMEOUT);
    judge_wheel(LEFT, ticks);
    judge_wheel(RIGHT, ticks);
}

int16_t drive_level(uint8_t motor)
{
    return level[motor];
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
    }
    return report;
}

uint8_t drive_wiring(void)
{
    return wiring;
}
