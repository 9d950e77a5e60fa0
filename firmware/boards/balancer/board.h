#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "balancer_protocol.h"

#define BOARD_KIND BALANCER_BOARD
#define BAUD 500000UL               /* for the preprocessor */
_Static_assert(BAUD == BALANCER_BAUD, "the wire's baud is declared in balancer_protocol.h");

/* Frames of this board alone; the largest one says how long a frame may be. */
#define BOARD_FRAMES \
    struct balance balance; \
    struct balance_configure balance_configure; \
    struct balance_drive balance_drive; \
    struct balance_estop balance_estop;

/* Timer 0 divides 16 MHz by 64: 250 counts a millisecond, 4 us each. */
#define CLOCK_COUNTS_PER_MS 250
#define CLOCK_US(counts) ((uint16_t)((counts) * 4u))

#endif
