/* The joystick board's registers but for the bus: ATmega328P. */
#include <avr/io.h>
#include "hal_joystick.h"
#include "pins.h"
#include "twi.h"

void hal_start_joystick(void)
{
    PORTD |= _BV(BUTTON);       /* pull-up */
    twi_start();
}

void hal_hold_sensor_in_reset(bool hold)
{
    if (hold)
        PORTD &= (uint8_t)~_BV(SENSOR_RESET);
    else
        PORTD |= _BV(SENSOR_RESET);
    DDRD |= _BV(SENSOR_RESET);
}

bool hal_button(void)
{
    return !(PIND & _BV(BUTTON));
}
