#include "boot.h"
#include "bumper_protocol.h"
#include "bumpers.h"
#include "clock.h"
#include "frame.h"
#include "hal_ranger.h"
#include "link.h"
#include "tick.h"

_Static_assert(sizeof(struct bumper) <= FRAME_BODY_MAX, "frame.h has room for it");
_Static_assert(BUMPERS <= 8, "a bit of one byte each");

static bool asked;
static uint8_t open;
static uint32_t open_ms[BUMPERS];       /* when each was last seen open */
static uint32_t period_ms;

void bumpers_start(void)
{
    hal_start_bumpers();
}

void bumpers_on_request(const void *body)
{
    (void)body;
    asked = true;
    period_ms = clock_ms() - BUMPER_PERIOD_MS;
}

/* Opens at once. Closes after a rest, since a contact that bounces is still pushed. */
static uint8_t read_switches(void)
{
    uint8_t now = open;
    for (uint8_t k = 0; k < BUMPERS; k++) {
        uint8_t bit = (uint8_t)(1 << k);
        if (hal_bumper_is_open(k)) {
            now |= bit;
            open_ms[k] = clock_ms();
        } else if (clock_ms() - open_ms[k] >= BUMPER_REST_MS) {
            now &= (uint8_t)~bit;
        }
    }
    return now;
}

static void send(void)
{
    struct held_tick tick = tick_newest();
    struct bumper bumper = {
        .type = FRAME_BUMPER,
        .seq = link_next_seq(),
        .board_us = clock_us(),
        .boot_id = boot_id(),
        .tick_epoch = tick.epoch,
        .tick_robot_ns = tick.robot_ns,
        .open = open,
    };
    link_send(&bumper, sizeof bumper);
}

void bumpers_poll(void)
{
    uint8_t before = open;
    open = read_switches();
    if (!asked)
        return;
    bool due = clock_due(&period_ms, BUMPER_PERIOD_MS);
    if (due || open != before)
        send();
}
