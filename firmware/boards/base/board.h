#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "transitions_protocol.h"

#define BOARD_KIND BOARD_BASE
#define BAUD 115200UL               /* for the preprocessor; UBRR = 9 exactly at 18.432 MHz */
_Static_assert(BAUD == BASE_BAUD, "the wire's baud is declared in protocol.h");

/* Frames of this board alone; the largest one says how long a frame may be. */
#define BOARD_FRAMES \
    struct transitions transitions; \
    struct transitions_request transitions_request;

/* Timer 0 divides 18.432 MHz by 256: 72 counts a millisecond, exactly. */
#define CLOCK_COUNTS_PER_MS 72
_Static_assert(CLOCK_COUNTS_PER_MS == STAMPS_PER_MS, "an edge's time is declared in protocol.h");
#define CLOCK_US(counts) ((uint16_t)((counts) * 222u / 16u))       /* 13.889 each, at most 2 us short */

#define HAS_LEVEL_LIMIT 0
#define HAS_TRANSITIONS 1           /* both channels have an interrupt at each change */

#endif
