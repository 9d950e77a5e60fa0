/* Whether a frame that moves the robot is new: of what the host has just heard, and ahead of the ones before it. */
#ifndef GIRAFF_FRESHNESS_H
#define GIRAFF_FRESHNESS_H
#include <stdbool.h>
#include <stdint.h>
#include "protocol.h"

/* Whether the host made the frame from telemetry old enough to matter. A time ahead of the board's is no better
 * than an old one: it comes out as a large age here. */
static inline bool is_stale(uint32_t echoed_ms, uint32_t now_ms)
{
    return now_ms - echoed_ms > ECHO_MAX_AGE_MS;
}

static inline bool is_newer(uint16_t seq, uint16_t than)
{
    uint16_t ahead = (uint16_t)(seq - than);
    return ahead && ahead < 0x8000;
}

static inline bool is_within(int32_t asked, uint32_t max)
{
    return (asked < 0 ? 0 - (uint32_t)asked : (uint32_t)asked) <= max;
}

#endif
