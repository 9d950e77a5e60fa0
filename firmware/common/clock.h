/* The board's time since its reset. Both counts wrap: compare them by subtraction only. */
#ifndef GIRAFF_CLOCK_H
#define GIRAFF_CLOCK_H
#include <stdbool.h>
#include <stdint.h>

void clock_start(void);
uint32_t clock_ms(void);
uint32_t clock_us(void);

/* Whether period_ms have gone by since *last_ms, which is then moved on by as much. */
bool clock_due(uint32_t *last_ms, uint16_t period_ms);

/* The time in CLOCK_COUNTS_PER_MS of board.h, for what wants it finer than us and in few instructions: in interrupts.
 * Wraps within a second. Interrupts off. */
uint16_t clock_stamp(void);

void clock_on_millisecond(void);        /* from the timer's interrupt */

#endif
