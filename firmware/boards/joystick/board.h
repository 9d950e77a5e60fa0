#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "protocol.h"

#define BOARD_KIND BOARD_JOYSTICK
#define BAUD 500000UL               /* for the preprocessor */
_Static_assert(BAUD == JOYSTICK_BAUD, "the wire's baud is declared in protocol.h");

/* Timer 0 divides 16 MHz by 64: 250 counts a millisecond. */
#define CLOCK_COUNTS_PER_MS 250
#define CLOCK_US(counts) ((uint16_t)((counts) * 4u))

#endif
