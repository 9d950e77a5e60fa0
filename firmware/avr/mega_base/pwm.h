/* What the drivers of a Mega's motors share: PWM by timers of 16 bits. */
#ifndef GIRAFF_PWM_H
#define GIRAFF_PWM_H
#include <avr/io.h>
#include <stdbool.h>
#include <stdint.h>
#include "board.h"
#include "mega.h"
#include "pins.h"

/* Fast PWM up to ICRn (mode 14), undivided: 16 MHz / 765 = 20.9 kHz, which nobody hears and each driver bears (25 kHz by
 * the data sheets of L298N and BTS7960). Each count of 255 is three of the timer. Datasheet, "Fast PWM Mode": a compare
 * register is taken over as the next period begins. */
enum { TIMER_COUNTS_PER_COUNT = 3, TIMER_COUNTS = 255 * TIMER_COUNTS_PER_COUNT };

#define SET_HIGH(pin) (PORT(pin) |= BIT(pin))
#define SET_LOW(pin) (PORT(pin) &= (uint8_t)~BIT(pin))

#define CONNECT(pin, counts) do { \
    COMPARE(pin) = (uint16_t)((counts) * TIMER_COUNTS_PER_COUNT - 1); \
    CONTROL(pin) |= CONNECTED(pin); \
} while (0)

/* The pin follows its PORT bit, low, at once. The compare register is zero long before PWM is connected again. */
#define DISCONNECT(pin) do { \
    CONTROL(pin) &= (uint8_t)~CONNECTED(pin); \
    COMPARE(pin) = 0; \
} while (0)

#endif
