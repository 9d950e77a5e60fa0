/* The line and the clock of a base board on an Arduino Mega. */
#ifndef GIRAFF_BASE_ON_MEGA_H
#define GIRAFF_BASE_ON_MEGA_H
#include "protocol.h"

#define BAUD 115200UL               /* for the preprocessor */
#define BAUD_TOL 3                  /* 117647 at 16 MHz, 2.1 % more: the Mega's own USB chip makes the same of it */
_Static_assert(BAUD == BASE_BAUD, "the wire's baud is declared in protocol.h");

/* Timer 0 divides 16 MHz by 64: 250 counts a millisecond, 4 us each. Edges' times are given out in the wire's stamps. */
#define CLOCK_COUNTS_PER_MS 250
#define CLOCK_US(counts) ((uint16_t)((counts) * 4u))
#define CLOCK_STAMPS_PER_MS STAMPS_PER_MS
#define CLOCK_STAMPS(counts) ((uint8_t)((counts) * 74u >> 8))
_Static_assert(CLOCK_COUNTS_PER_MS * 74 >> 8 == STAMPS_PER_MS, "an edge's time is declared in protocol.h");

#endif
