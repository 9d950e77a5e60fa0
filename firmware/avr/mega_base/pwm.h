/* What the drivers of a Mega's motors share: PWM by timers of 16 bits. */
#ifndef GIRAFF_PWM_H
#define GIRAFF_PWM_H
#include <avr/io.h>
#include <stdbool.h>
#include <stdint.h>
#include "board.h"
#include "mega.h"
#include "pins.h"

/* Fast PWM up to ICRn (mode 14); the driver's header says how fast. Datasheet, "Fast PWM Mode": a compare register is taken
 * over as the next period begins. */
enum { TIMER_COUNTS = 255 * TIMER_COUNTS_PER_COUNT };

#define SET_HIGH(pin) (PORT(pin) |= BIT(pin))
#define SET_LOW(pin) (PORT(pin) &= (uint8_t)~BIT(pin))

/* A motor that starts does so with a new period: else the rest of one would have what was asked before it was off. A timer
 * that is set to its top itself may miss it. */
#define CONNECT(pin, counts) do { \
    COMPARE(pin) = (uint16_t)((counts) * TIMER_COUNTS_PER_COUNT - 1); \
    if (!(CONTROL(pin) & CONNECTED(pin))) { \
        COUNTER(pin) = TIMER_COUNTS - 3; \
        CONTROL(pin) |= CONNECTED(pin); \
    } \
} while (0)

/* The pin follows its PORT bit, low, at once. */
#define DISCONNECT(pin) (CONTROL(pin) &= (uint8_t)~CONNECTED(pin))

#endif
