#include <stdbool.h>
#include "drive.h"
#include "hal.h"

enum { MOTORS = 2, WIRING_BITS = 2 * WIRING_INVERT_RIGHT_ENCODER - 1 };

/* Shared with the millisecond interrupt: these change together or not at all. */
static volatile uint8_t state = DRIVE_NOT_CONFIGURED;
static volatile uint16_t time_left_ms;          /* until the command time-out, while active */
static volatile int16_t level[MOTORS];

/* Of the session. */
static uint32_t session;                        /* 0 = none since the boot */
static uint8_t wiring;
static uint8_t level_max;
static bool has_accepted;
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

static void stop(enum drive_state why)
{
    state = why;
    for (uint8_t motor = 0; motor < MOTORS; motor++)
        level[motor] = 0;
}

static enum refusal judge_configure(const struct configure *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->protocol_hash != PROTOCOL_HASH)
        return REFUSAL_PROTOCOL;
    if (!asked->session || !asked->level_max || asked->wiring & ~WIRING_BITS)
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
    if (has_accepted && !is_newer(asked->seq, last_seq))
        return REFUSAL_SEQUENCE;
    if (!is_within(asked->left_level, level_max) || !is_within(asked->right_level, level_max))
        return REFUSAL_LEVEL;
    return REFUSAL_NONE;
}

static void refuse(enum refusal why)
{
    last_refusal = (uint8_t)why;
    refused++;
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
    }
    session = asked->session;
    wiring = asked->wiring;
    level_max = asked->level_max;
    has_accepted = false;
}

void drive_on_command(const struct drive *asked, uint32_t boot_id, uint32_t now_ms)
{
    enum refusal refusal = judge_drive(asked, boot_id, now_ms);
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    int16_t left = wiring_level(wiring, LEFT, asked->left_level);
    int16_t right = wiring_level(wiring, RIGHT, asked->right_level);
    bool opens = !left && !right;
    bool done = false;
    ATOMICALLY {        /* the time-out may latch up to here, and is looked at here */
        if (opens || state == DRIVE_ACTIVE) {
            state = DRIVE_ACTIVE;
            time_left_ms = COMMAND_TIMEOUT_MS;
            level[wiring_motor(wiring, LEFT)] = left;
            level[wiring_motor(wiring, RIGHT)] = right;
            done = true;
        }
    }
    if (!done) {
        refuse(REFUSAL_AWAITING_ZERO);
        return;
    }
    has_accepted = true;
    last_seq = asked->seq;
    accepted++;
}

void drive_on_millisecond(void)
{
    if (state == DRIVE_ACTIVE && --time_left_ms == 0)
        stop(DRIVE_COMMAND_TIMEOUT);
}

int16_t drive_level(uint8_t motor)
{
    return level[motor];
}

struct drive_report drive_report(void)
{
    return (struct drive_report){
        .session = session,
        .drive_state = state,
        .last_refusal = last_refusal,
        .accepted = accepted,
        .refused = refused,
    };
}

uint8_t drive_wiring(void)
{
    return wiring;
}
