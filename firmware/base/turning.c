#include <stdbool.h>
#include "protocol.h"
#include "turning.h"

/* A slice of time: 5 ticks at 0.10 m/s. The last of OPPOSITE_MS tells whether the wheel still slows down. */
enum { SLICE_MS = 25 };
_Static_assert(OPPOSITE_MS % SLICE_MS == 0, "whole slices");

static int8_t direction_of(int16_t level)
{
    return level > 0 ? 1 : level < 0 ? -1 : 0;
}

static void begin_slice(struct turning *t, uint16_t ticks)
{
    t->slice_ms = 0;
    t->slice_ticks = ticks;
}

static void restart(struct turning *t, int8_t direction, uint16_t ticks)
{
    t->direction = direction;
    t->left_at = ticks;
    t->pushed_ms = 0;
    t->slowest = UINT16_MAX;    /* it may coast, however fast */
    t->against_ms = 0;
    begin_slice(t, ticks);
}

/* Where it is counts, not how many edges came: a wheel that trembles on an edge stands still. A level below
 * stall_level neither counts nor forgives, so that one which swings about it hides nothing. */
static bool is_stuck(struct turning *t, int16_t level, uint8_t stall_level, uint16_t ticks)
{
    int16_t moved = (int16_t)(ticks - t->left_at);
    if (moved >= STUCK_EDGES || moved <= -STUCK_EDGES) {
        t->left_at = ticks;
        t->pushed_ms = 0;
        return false;
    }
    if ((level < 0 ? -level : level) >= stall_level)
        t->pushed_ms++;
    return t->pushed_ms >= STUCK_MS;
}

/* A wheel that coasts when its level has been reversed turns against it, too, but ever slower. One that has stood
 * or turned the right way has nothing left to coast with. */
static bool is_opposite(struct turning *t, uint16_t ticks)
{
    if (++t->slice_ms < SLICE_MS)
        return false;
    int16_t against = (int16_t)(t->direction > 0 ? t->slice_ticks - ticks : ticks - t->slice_ticks);
    begin_slice(t, ticks);
    uint16_t turned = against > 0 ? (uint16_t)against : 0;
    bool slows = turned < t->slowest;
    if (slows)
        t->slowest = turned;
    t->against_ms = slows || !turned ? 0 : t->against_ms + SLICE_MS;
    return t->against_ms >= OPPOSITE_MS;
}

enum turns turning_judge(struct turning *t, int16_t level, uint8_t stall_level, uint16_t ticks)
{
    int8_t direction = direction_of(level);
    if (direction != t->direction)
        restart(t, direction, ticks);
    if (!direction)
        return TURNS_AS_TOLD;
    if (is_opposite(t, ticks))
        return TURNS_OPPOSITE;
    return is_stuck(t, level, stall_level, ticks) ? TURNS_STUCK : TURNS_AS_TOLD;
}
