#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "boards.h"
#include "protocol.h"

#define BOARD_KIND NANO_RANGER_BOARD
#define BAUD 500000UL               /* for the preprocessor */
_Static_assert(BAUD == RANGER_BAUD, "the wire's baud is declared in protocol.h");

/* Timer 0 divides 16 MHz by 64: 250 counts a millisecond, 4 us or 0.7 mm each. */
#define CLOCK_COUNTS_PER_MS 250
#define CLOCK_US(counts) ((uint16_t)((counts) * 4u))

#endif
