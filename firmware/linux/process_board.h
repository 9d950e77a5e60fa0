/* What all boards have in common that are processes. A board's board.h has its number, and includes this. */
#ifndef GIRAFF_PROCESS_BOARD_H
#define GIRAFF_PROCESS_BOARD_H
#include "boards.h"
#include "protocol.h"

#define BAUD 115200UL               /* what the host opens its pseudo terminal with */
_Static_assert(BAUD == BASE_BAUD, "the wire's baud is declared in protocol.h");

#define CLOCK_COUNTS_PER_MS 72
_Static_assert(CLOCK_COUNTS_PER_MS == STAMPS_PER_MS, "an edge's time is declared in protocol.h");
#define CLOCK_US(counts) ((uint16_t)((counts) * 222u / 16u))

#define HAS_LEVEL_LIMIT 0
#define HAS_TRANSITIONS 0

#endif
