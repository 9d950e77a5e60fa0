/* The ranger board's registers: ATmega2560. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/delay.h>
#include "hal_ranger.h"
#include "pins.h"
#include "sonars.h"

enum { TRIGGER_US = 12 };       /* the HC-SR04 wants 10 */

void hal_start_sonars(void)
{
    DDRA |= _BV(TRIGGER_0) | _BV(TRIGGER_0 + 1) | _BV(TRIGGER_0 + 2);
    PORTE |= _BV(ECHO_0) | _BV(ECHO_1);         /* pull-ups: a wire that is off reads as stuck, not as an echo */
    PORTD |= _BV(ECHO_2);
    EICRB = _BV(ISC40) | _BV(ISC50);            /* any edge */
    EICRA = _BV(ISC30);
    EIFR = _BV(INTF3) | _BV(INTF4) | _BV(INTF5);
    EIMSK = _BV(INT3) | _BV(INT4) | _BV(INT5);
}

void hal_trigger(uint8_t sensor)
{
    uint8_t pin = (uint8_t)_BV(TRIGGER_0 + sensor);
    PORTA |= pin;
    _delay_us(TRIGGER_US);
    PORTA &= (uint8_t)~pin;
}

bool hal_echo_line(uint8_t sensor)
{
    switch (sensor) {
    case 0: return PINE & _BV(ECHO_0);
    case 1: return PINE & _BV(ECHO_1);
    default: return PIND & _BV(ECHO_2);
    }
}

void hal_start_bumpers(void)
{
    PORTC |= _BV(BUMPER_0) | _BV(BUMPER_0 + 1);     /* pull-ups: a wire that is off reads as pushed */
}

bool hal_bumper_is_open(uint8_t bumper)
{
    return PINC & _BV(BUMPER_0 + bumper);
}

ISR(INT4_vect)
{
    sonars_on_edge(0, hal_echo_line(0));
}

ISR(INT5_vect)
{
    sonars_on_edge(1, hal_echo_line(1));
}

ISR(INT3_vect)
{
    sonars_on_edge(2, hal_echo_line(2));
}
