/* The registers of the ranger on an Arduino Nano: ATmega328P. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/delay.h>
#include "hal_ranger.h"
#include "pins.h"
#include "sonars.h"

enum { TRIGGER_US = 12 };       /* the HC-SR04 wants 10 */

static const uint8_t ECHOES = _BV(ECHO_0) | _BV(ECHO_0 + 1) | _BV(ECHO_0 + 2);

static uint8_t levels;          /* of the echo lines, as they were last seen; of the interrupt, once it is on */

void hal_start_sonars(void)
{
    DDRB |= _BV(TRIGGER_0) | _BV(TRIGGER_0 + 1) | _BV(TRIGGER_0 + 2);
    PORTD |= ECHOES;            /* pull-ups: a wire that is off reads as stuck, not as an echo */
    PCMSK2 = ECHOES;            /* bit k of it is PDk */
    PCIFR = _BV(PCIF2);
    levels = PIND & ECHOES;
    PCICR = _BV(PCIE2);
}

void hal_trigger(uint8_t sensor)
{
    uint8_t pin = (uint8_t)_BV(TRIGGER_0 + sensor);
    PORTB |= pin;
    _delay_us(TRIGGER_US);
    PORTB &= (uint8_t)~pin;
}

bool hal_echo_line(uint8_t sensor)
{
    return PIND & _BV(ECHO_0 + sensor);
}

void hal_start_bumpers(void)
{
    PORTB |= _BV(BUMPER_0) | _BV(BUMPER_0 + 1);     /* pull-ups: a wire that is off reads as pushed */
}

bool hal_bumper_is_open(uint8_t bumper)
{
    return PINB & _BV(BUMPER_0 + bumper);
}

/* One interrupt for all echo lines, at any edge of each. */
ISR(PCINT2_vect)
{
    uint8_t now = PIND & ECHOES;
    uint8_t changed = now ^ levels;
    levels = now;
    for (uint8_t sensor = 0; sensor < RANGE_SENSORS; sensor++) {
        uint8_t line = (uint8_t)_BV(ECHO_0 + sensor);
        if (changed & line)
            sonars_on_edge(sensor, now & line);
    }
}
