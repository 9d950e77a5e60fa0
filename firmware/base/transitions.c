#include "transitions.h"
#include "boot.h"
#include "clock.h"
#include "hal.h"
#include "hal_base.h"
#include "link.h"
#include "transitions_protocol.h"

_Static_assert(STAMPS_PER_MS == CLOCK_STAMPS_PER_MS, "the interrupt stores what it subtracts");

enum { RING_SIZE = 128, RING_MASK = RING_SIZE - 1, BOTH = TRANSITION_A | TRANSITION_B };

/* The interrupt fills it, the main loop empties it. */
static volatile uint16_t ring[RING_SIZE];
static volatile uint8_t head, tail;         /* equal: empty */
static volatile bool is_full;               /* since then all are dropped, until the ring is empty */

/* The interrupt's own, but while nothing is watched. */
static uint16_t levels;                     /* after the newest change */
static volatile uint16_t newest;            /* its stamp */
static volatile bool is_unknown;            /* how long ago it was, or whether others were lost */

static uint8_t watched = TRANSITIONS_OF_NONE;
static uint32_t asked_ms, sent_ms;

static void watch(uint8_t encoder)
{
    hal_watch_encoder(TRANSITIONS_OF_NONE);
    watched = encoder;
    head = tail = 0;
    is_full = false;
    is_unknown = true;
    levels = ~BOTH & UINT16_MAX;            /* no pins have these: the first change counts */
    sent_ms = clock_ms() - TRANSITIONS_PERIOD_MS;
    hal_watch_encoder(encoder);
}

void transitions_on_request(const void *body)
{
    const struct transitions_request *request = body;
    uint8_t encoder = request->encoder;
    if (encoder > 1 && encoder != TRANSITIONS_OF_NONE)
        return;
    asked_ms = clock_ms();
    if (encoder != watched)
        watch(encoder);
}

void transitions_on_change(bool a, bool b)
{
    uint16_t stamp = clock_stamp(), since = (uint16_t)(stamp - newest);
    uint16_t now = (uint16_t)((a ? TRANSITION_A : 0) | (b ? TRANSITION_B : 0)), changed = now ^ levels;
    if (!changed)
        return;
    levels = now;
    newest = stamp;
    if (changed == BOTH)
        is_unknown = true;                  /* one of them was too short to be seen alone */
    uint8_t at = head, next = (uint8_t)(at + 1) & RING_MASK;
    if (is_full || next == tail) {
        is_full = is_unknown = true;
        return;
    }
    if (is_unknown || since > TRANSITION_STAMPS)
        since = TRANSITION_STAMPS;
    is_unknown = false;
    ring[at] = now | since;
    head = next;
}

static uint8_t waiting(void)
{
    return (uint8_t)(head - tail) & RING_MASK;
}

static void send(void)
{
    struct transitions frame = {
        .type = FRAME_TRANSITIONS,
        .seq = link_next_seq(),
        .board_us = clock_us(),
        .boot_id = boot_id(),
        .encoder = watched,
    };
    uint8_t from = tail;
    for (uint8_t n = waiting(); n && frame.count < TRANSITIONS_MAX; n--) {
        frame.transitions[frame.count++] = ring[from];
        from = (uint8_t)(from + 1) & RING_MASK;
    }
    tail = from;
    link_send(&frame, sizeof frame);
    sent_ms = clock_ms();
}

void transitions_poll(void)
{
    if (watched == TRANSITIONS_OF_NONE)
        return;
    if (clock_ms() - asked_ms >= TRANSITIONS_HOLD_MS) {
        watch(TRANSITIONS_OF_NONE);
        return;
    }
    ATOMICALLY {                            /* before the stamps wrap */
        if ((uint16_t)(clock_stamp() - newest) > TRANSITION_STAMPS)
            is_unknown = true;
    }
    bool due = is_full || waiting() >= TRANSITIONS_MAX || clock_ms() - sent_ms >= TRANSITIONS_PERIOD_MS;
    if (due && link_has_room(sizeof(struct transitions), sizeof(struct wheels)))
        send();
    if (is_full && !waiting())
        is_full = false;
}
