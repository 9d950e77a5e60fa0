#include "controller.h"
#include "counted.h"
#include "drive.h"
#include "duty.h"
#include "hal_base.h"
#include "system.h"

static const struct protocol *spoken;
static bool is_proved, answers;
static const char *lost;

static enum step step;                          /* of the newest request */
static uint8_t number, other;
static bool waits;                              /* for its reply */
static bool rests;                              /* nothing is asked before the line has been silent for quiet_ms */
static uint8_t missing;                         /* not 0: no reply came to the newest requests */
static bool is_disobeyed;                       /* a command has no answer, */
static uint32_t disobeyed_ms;                   /* and neither has any since then */
static uint32_t asked_ms, byte_ms, heard_ms, kept_ms, cycle_ms, other_ms;
static uint32_t counted[CONTROLLER_MOTORS];
static bool is_counted;
static uint16_t battery;                        /* tenths of a volt */

void controller_start(const struct protocol *of_controller, uint32_t now_ms)
{
    spoken = of_controller;
    step = STEP_PROVE;
    rests = true;               /* after whatever was under way before the reset */
    byte_ms = now_ms;
}

void controller_begin(uint32_t now_ms)
{
    heard_ms = kept_ms = cycle_ms = other_ms = now_ms;
}

bool controller_is_proved(void)
{
    return is_proved;
}

bool controller_answers(void)
{
    return answers;
}

const char *controller_lost(void)
{
    return lost;
}

void controller_tell_counters(const uint32_t counters[CONTROLLER_MOTORS])
{
    for (uint8_t wheel = 0; wheel < CONTROLLER_MOTORS; wheel++) {
        uint32_t more = counters[wheel] - counted[wheel];
        if (is_counted && more + spoken->leap > 2 * spoken->leap)
            lost = "the controller has begun to count anew: its power was off";
    }
    if (lost)
        return;
    for (uint8_t wheel = 0; wheel < CONTROLLER_MOTORS; wheel++)
        counted[wheel] = counters[wheel];
    is_counted = true;
    counted_on_reading(counters);
}

void controller_tell_battery(uint16_t tenths)
{
    battery = tenths;
}

void hal_start_battery(void)
{
}

uint16_t hal_battery_counts(void)
{
    return battery;
}

void controller_tell_stop(void)
{
    const struct estop engage = { .engage = 1 };
    drive_on_estop(&engage, 0, 0);
}

static void ask(enum step what, uint8_t which, uint32_t now_ms)
{
    uint8_t bytes[CONTROLLER_REQUEST_MAX];
    int16_t duty[CONTROLLER_MOTORS] = { 0, 0 };
    if (what == STEP_COMMAND)
        duty_take(duty, missing != 0);
    if (what == STEP_COMMAND && !is_disobeyed) {
        is_disobeyed = true;
        disobeyed_ms = now_ms;
    }
    step = what;
    number = which;
    waits = true;
    asked_ms = now_ms;
    system_line_write(bytes, spoken->ask(bytes, what, which, duty));
}

static void on_reply(uint32_t now_ms)
{
    waits = false;
    missing = 0;
    heard_ms = now_ms;
    if (step == STEP_PROVE && ++number == spoken->proofs)
        is_proved = true;
    if (step == STEP_COMMAND)
        is_disobeyed = false;
}

/* An acknowledgement names nothing: one that comes late must not be taken for that of the next request. */
static void on_missing(uint32_t now_ms)
{
    waits = false;
    rests = true;
    byte_ms = now_ms;
    if (missing < UINT8_MAX)
        missing++;
    if (step == STEP_COMMAND)
        duty_forget();
    if (!is_proved)
        number = 0;             /* that is its stop, again */
}

void controller_on_byte(uint8_t byte, uint32_t now_ms)
{
    byte_ms = now_ms;
    answers = true;
    if (!waits) {
        rests = true;
        return;
    }
    switch (spoken->hear(byte)) {
    case HEARD_PART:
        break;
    case HEARD_KEPT:
        kept_ms = now_ms;
        on_reply(now_ms);
        break;
    case HEARD_ALL:
        on_reply(now_ms);
        break;
    case HEARD_OTHERWISE:
        if (is_proved)
            lost = "the controller is not any more as it has proved to be";
        on_missing(now_ms);
        break;
    default:
        on_missing(now_ms);
    }
}

static bool has_gone_by(uint32_t since_ms, uint8_t period_ms, uint32_t now_ms)
{
    return now_ms - since_ms >= period_ms;
}

static void judge_silence(uint32_t now_ms)
{
    if (waits && has_gone_by(asked_ms, spoken->reply_ms, now_ms))
        on_missing(now_ms);
    if (!is_proved || lost)
        return;
    if (has_gone_by(heard_ms, spoken->lost_ms, now_ms))
        lost = "the controller is silent";
    else if (is_disobeyed && has_gone_by(disobeyed_ms, spoken->lost_ms, now_ms))
        lost = "the controller answers, but to no command";
    else if (spoken->kept_ms && has_gone_by(kept_ms, spoken->kept_ms, now_ms))
        lost = "the controller does not say its time-out";
}

/* Whatever drives goes only after an answer, so that no two of it can wait in an adapter. */
static void ask_next(uint32_t now_ms)
{
    if (!is_proved) {
        ask(STEP_PROVE, number, now_ms);
    } else if (duty_must_stop()) {
        ask(STEP_COMMAND, 0, now_ms);
    } else if (missing || step == STEP_COMMAND || step == STEP_PROVE) {
        ask(STEP_COUNTERS, 0, now_ms);
    } else if (spoken->others && has_gone_by(other_ms, spoken->other_ms, now_ms)) {
        other_ms = now_ms;
        ask(STEP_OTHER, other, now_ms);
        other = (uint8_t)((other + 1) % spoken->others);
    } else if (has_gone_by(cycle_ms, spoken->cycle_ms, now_ms)) {
        cycle_ms = now_ms;
        ask(STEP_COMMAND, 0, now_ms);
    }
}

void controller_turn(uint32_t now_ms)
{
    judge_silence(now_ms);
    if (lost || waits || (rests && !has_gone_by(byte_ms, spoken->quiet_ms, now_ms)))
        return;
    rests = false;
    ask_next(now_ms);
}
