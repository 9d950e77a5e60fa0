/* The milliseconds of a board that is a process. ticks.c implements the clock of hal.h by them. */
#ifndef GIRAFF_TICKS_H
#define GIRAFF_TICKS_H
#include <stdbool.h>
#include <stdint.h>

uint64_t ticks_due_ns(void);     /* the millisecond under way ends; 0 = the clock has not begun */
bool ticks_take_due(void);      /* whether a millisecond is over, which then counts as gone by */

#endif
