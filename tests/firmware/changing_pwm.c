/* PWM of both motors changes three times a millisecond, whatever the program does; other interrupts go on. */
#include <avr/interrupt.h>
#include "hal_base.h"
#include "start_values.h"

const struct start_values start_values = { 0 };

static void __attribute__((constructor)) start_timer_2(void)
{
    TCCR2A = _BV(WGM21);
    OCR2A = 16000000 / 64 / 3000 - 1;
    TIMSK2 = _BV(OCIE2A);
    TCCR2B = _BV(CS22);
}

ISR(TIMER2_COMPA_vect, ISR_NOBLOCK)
{
    static uint8_t counts;
    counts += 37;
    for (uint8_t motor = 0; motor < 2; motor++) {
        hal_motor_direction(motor, true);
        hal_motor_pwm(motor, counts | 1);
    }
}
