/* Timer 0 counts to a millisecond, again and again. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include "board.h"
#include "clock.h"
#include "firmware.h"
#include "hal.h"

#if F_CPU / CLOCK_COUNTS_PER_MS / 1000 == 64
#define PRESCALER (_BV(CS01) | _BV(CS00))
#elif F_CPU / CLOCK_COUNTS_PER_MS / 1000 == 256
#define PRESCALER _BV(CS02)
#else
#error "timer 0 has no such prescaler"
#endif

ISR(TIMER0_COMPA_vect)
{
    firmware_on_millisecond();
}

void hal_start_clock(void)
{
    TCCR0A = _BV(WGM01);            /* clear on compare match */
    OCR0A = CLOCK_COUNTS_PER_MS - 1;
    TIMSK0 = _BV(OCIE0A);
    TCCR0B = PRESCALER;
}

uint8_t hal_clock_stamps(void)
{
    uint8_t counts = TCNT0;
    if (!(TIFR0 & _BV(OCF0A)))
        return CLOCK_STAMPS(counts);
    return CLOCK_STAMPS(CLOCK_COUNTS_PER_MS + TCNT0);   /* a millisecond has ended and its interrupt waits */
}

uint16_t hal_clock_us(void)
{
    uint8_t counts = TCNT0;
    if (!(TIFR0 & _BV(OCF0A)))
        return CLOCK_US(counts);
    return (uint16_t)(1000 + CLOCK_US(TCNT0));      /* a millisecond has ended and its interrupt waits */
}
