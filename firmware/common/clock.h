/* The board's time since its reset. Both counts wrap: compare them by subtraction only. */
#ifndef GIRAFF_CLOCK_H
#define GIRAFF_CLOCK_H
#include <stdbool.h>
#include <stdint.h>
#include "board.h"

/* A stamp is a count of the board's timer, unless its board.h makes stamps of so many counts. */
#ifndef CLOCK_STAMPS
#define CLOCK_STAMPS(counts) ((uint8_t)(counts))
#define CLOCK_STAMPS_PER_MS CLOCK_COUNTS_PER_MS
#endif

void clock_start(void);
uint32_t clock_ms(void);
uint32_t clock_us(void);

/* Whether period_ms have gone by since *last_ms, which is then moved on by as much. */
bool clock_due(uint32_t *last_ms, uint16_t period_ms);

/* The time in CLOCK_STAMPS_PER_MS, for what wants it in few instructions and in 16 bits: in interrupts. Wraps within a
 * second. Interrupts off. */
uint16_t clock_stamp(void);

/* Both times of an instant after the last millisecond that was counted. From the timer's interrupt. */
uint16_t clock_stamp_after(uint16_t counts);    /* of the timer, less than two milliseconds */
uint32_t clock_us_after(uint16_t later_us);

void clock_on_millisecond(void);        /* from the timer's interrupt */

#endif
