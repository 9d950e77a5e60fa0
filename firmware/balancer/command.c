#include <string.h>
#include "command.h"
#include "driver.h"
#include "freshness.h"
#include "hal.h"
#include "latch.h"
#include "settings.h"

static uint8_t drive_state = DRIVE_NOT_CONFIGURED;
static struct balance_configure in_force;       /* the session's; what is of its frame alone is 0 */
static bool has_last_seq;
static uint16_t last_seq;
static int32_t linear_um_s, angular_urad_s;     /* as accepted last, while active */
static uint8_t ask;
static bool sits;                               /* asked for since the last period */
static uint32_t accepted_ms;
static uint8_t free_side;

/* As the last period left them. */
static uint8_t posture = BALANCE_OFF;
static uint32_t off_ms;                         /* when it went off, or was released, or a session began, */
static bool host_knows;                         /* and whether a host that has been told since has said so */
static uint32_t held_ms;

static uint8_t last_refusal = REFUSAL_NONE;
static uint16_t accepted, refused;

/* Any cause that this board does not have is of a torn or a foreign EEPROM. */
static uint8_t latched(void)
{
    uint8_t cause = (uint8_t)latch_cause();
    return cause <= BALANCE_LATCH_STANDS ? cause : BALANCE_LATCH_OFF;
}

/* A latch outlasts every other reason not to drive. */
static void stop(enum drive_state why)
{
    drive_state = latched() ? DRIVE_LATCHED : (uint8_t)why;
    linear_um_s = angular_urad_s = 0;
    ask = ASK_KEEP;
}

static void refuse(enum refusal why)
{
    last_refusal = (uint8_t)why;
    refused++;
}

static void ask_anew(uint32_t now_ms)
{
    off_ms = now_ms;
    host_knows = false;
}

void command_start(void)
{
    latch_start();
    stop(DRIVE_NOT_CONFIGURED);
}

static enum refusal judge_configure(
    const struct balance_configure *asked, struct balance_settings *settings, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->protocol_hash != PROTOCOL_HASH || !asked->session || !settings_read(asked, settings))
        return REFUSAL_PROTOCOL;
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms))
        return REFUSAL_STALE;
    if (posture != BALANCE_OFF && asked->wiring != in_force.wiring)
        return REFUSAL_PROTOCOL;        /* what it stands by is not turned round under it */
    return REFUSAL_NONE;
}

/* A robot that stands goes on standing, on the spot: base may restart beside people. */
void command_on_configure(const struct balance_configure *asked, uint32_t boot_id, uint32_t now_ms)
{
    struct balance_settings settings;
    enum refusal refusal = judge_configure(asked, &settings, boot_id, now_ms);
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    struct balance_configure before = in_force;
    in_force = *asked;
    in_force.seq = 0;
    in_force.board_ms = 0;
    before.session = in_force.session;
    if (memcmp(&before, &in_force, sizeof before) != 0) {
        balance_configure(&settings);
        driver_cut_off_below(asked->driver_min_mv);
    }
    has_last_seq = false;
    ask_anew(now_ms);
    stop(DRIVE_AWAITING_ZERO);
}

static enum refusal judge_drive(const struct balance_drive *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms))
        return REFUSAL_STALE;
    if (!in_force.session)
        return REFUSAL_NOT_CONFIGURED;
    if (has_last_seq && !is_newer(asked->seq, last_seq))
        return REFUSAL_SEQUENCE;
    if (!is_within(asked->linear_um_s, in_force.speed_max_mm_s * 1000ul)
        || !is_within(asked->angular_urad_s, in_force.turn_max_mrad_s * 1000ul)
        || asked->ask > ASK_SIT || asked->free_side > SIDE_BACKWARD)
        return REFUSAL_LEVEL;
    return REFUSAL_NONE;
}

/* Only a robot that stands may drive. So one that stands up again waits for a zero frame. */
static enum refusal judge_state(const struct balance_drive *asked, uint32_t now_ms)
{
    bool opens = !asked->linear_um_s && !asked->angular_urad_s;
    if (drive_state == DRIVE_LATCHED)
        return REFUSAL_LATCHED;
    if (drive_state == DRIVE_HELD && now_ms - asked->board_ms >= now_ms - held_ms)
        return REFUSAL_AWAITING_ZERO;   /* of a host that cannot know yet */
    if (!opens && (drive_state != DRIVE_ACTIVE || posture != BALANCE_STANDS))
        return REFUSAL_AWAITING_ZERO;
    return REFUSAL_NONE;
}

void command_on_drive(const struct balance_drive *asked, uint32_t boot_id, uint32_t now_ms)
{
    enum refusal refusal = judge_drive(asked, boot_id, now_ms);
    if (refusal == REFUSAL_NONE) {
        /* Taken whatever becomes of it: a host uses up all numbers within 11 minutes, and a latch may last longer. */
        has_last_seq = true;
        last_seq = asked->seq;
        refusal = judge_state(asked, now_ms);
    }
    if (refusal != REFUSAL_NONE) {
        refuse(refusal);
        return;
    }
    accepted++;
    accepted_ms = now_ms;
    drive_state = DRIVE_ACTIVE;
    linear_um_s = asked->linear_um_s;
    angular_urad_s = asked->angular_urad_s;
    ask = asked->ask;
    free_side = asked->free_side;
    if (ask == ASK_SIT)
        sits = true;
    if (ask == ASK_KEEP && posture == BALANCE_OFF && now_ms - asked->board_ms < now_ms - off_ms)
        host_knows = true;
}

/* Besides, it must be younger than the latch: one made before it releases something else. */
static enum refusal judge_release(const struct balance_estop *asked, uint32_t boot_id, uint32_t now_ms)
{
    if (asked->boot_id != boot_id)
        return REFUSAL_BOOT_ID;
    if (is_stale(asked->board_ms, now_ms) || now_ms - asked->board_ms >= latch_age_ms())
        return REFUSAL_STALE;
    if (!in_force.session || asked->session != in_force.session)
        return REFUSAL_NOT_CONFIGURED;
    return REFUSAL_NONE;
}

static void engage(uint8_t wanted)
{
    if (wanted > latched())
        latch_release();
    latch_engage((enum latch)wanted);
    stop(DRIVE_LATCHED);
}

void command_on_cord(void)
{
    ATOMICALLY {        /* the interrupt keeps the latch in EEPROM */
        engage(BALANCE_LATCH_OFF);
    }
}

void command_on_estop(const struct balance_estop *asked, uint32_t boot_id, uint32_t now_ms)
{
    enum refusal refusal = REFUSAL_NONE;
    ATOMICALLY {        /* the interrupt keeps the latch in EEPROM */
        if (asked->engage) {
            engage(asked->engage == ENGAGE_STANDS ? BALANCE_LATCH_STANDS : BALANCE_LATCH_OFF);
        } else {
            refusal = judge_release(asked, boot_id, now_ms);
            if (refusal == REFUSAL_NONE && drive_state == DRIVE_LATCHED) {
                latch_release();
                ask_anew(now_ms);
                stop(DRIVE_AWAITING_ZERO);
            }
        }
    }
    if (refusal != REFUSAL_NONE)
        refuse(refusal);
}

static void follow(const struct balance_state *state, uint32_t now_ms)
{
    if (state->posture == posture)
        return;
    if (posture == BALANCE_STANDS && drive_state != DRIVE_NOT_CONFIGURED)
        stop(DRIVE_AWAITING_ZERO);
    posture = state->posture;
    if (posture == BALANCE_OFF)
        ask_anew(now_ms);
}

struct balance_order command_order(const struct balance_state *state, uint32_t now_ms)
{
    follow(state, now_ms);
    if (drive_state == DRIVE_ACTIVE && now_ms - accepted_ms >= COMMAND_TIMEOUT_MS)
        stop(DRIVE_COMMAND_TIMEOUT);
    if (drive_state == DRIVE_ACTIVE && state->flags & BALANCE_HELD && (linear_um_s || angular_urad_s)) {
        held_ms = now_ms;
        stop(DRIVE_HELD);
    }
    if (now_ms - accepted_ms >= FREE_SIDE_MS)
        free_side = SIDE_NONE;
    struct balance_order order = {
        .linear = (float)linear_um_s * 1e-6f,
        .angular = (float)angular_urad_s * 1e-6f,
        .halts = drive_state != DRIVE_ACTIVE,
        .may_stand = drive_state == DRIVE_ACTIVE && ask == ASK_STAND && host_knows,
        .sits = sits,
        .off = latched() == BALANCE_LATCH_OFF,
        .off_cause = CAUSE_ESTOP_OFF,
        .free_side = free_side,
    };
    sits = false;
    return order;
}

const struct balance_configure *command_session(void)
{
    return &in_force;
}

void command_report(struct balance *report)
{
    report->session = in_force.session;
    report->drive_state = drive_state;
    report->latch = latched();
    report->last_refusal = last_refusal;
    report->accepted = accepted;
    report->refused = refused;
}
