/* The registers of a base board on an Arduino Mega (ATmega2560) whose motors are driven by PWM. l298n.c and bts7960.c
 * have what differs by driver, and pins.h of the board where each wire is. */
#include <avr/interrupt.h>
#include "gathered.h"
#include "hal_base.h"
#include "pwm.h"

#define OR_BIT(pin) | 1ull << (pin)
#define PLUS_BIT(pin) + (1ull << (pin))
#define ENCODER_PINS(do) do(ENCODER_0_A) do(ENCODER_0_B) do(ENCODER_1_A) do(ENCODER_1_B)
_Static_assert((0 EACH_OUTPUT(OR_BIT) ENCODER_PINS(OR_BIT)) == (0 EACH_OUTPUT(PLUS_BIT) ENCODER_PINS(PLUS_BIT)),
               "pins.h uses a pin twice");

#define AND_IS_PWM(pin) && ((pin) == 2 || (pin) == 3 || (pin) == 5 || (pin) == 6 || (pin) == 7 || \
    (pin) == 8 || (pin) == 11 || (pin) == 12 || (pin) == 44 || (pin) == 45 || (pin) == 46)
_Static_assert(1 EACH_PWM_PIN(AND_IS_PWM), "pins.h has PWM at a pin other than 2, 3, 5 to 8, 11, 12, 44 to 46");

#define HAS_INTERRUPT(pin) ((pin) == 2 || (pin) == 3 || ((pin) >= 18 && (pin) <= 21))
_Static_assert(HAS_INTERRUPT(ENCODER_0_A) && HAS_INTERRUPT(ENCODER_1_A),
               "pins.h has channel A of an encoder at a pin other than 2, 3, 18 to 21");

#define NOT_TWI(pin) && (pin) != 20 && (pin) != 21
_Static_assert(1 EACH_OUTPUT(NOT_TWI), "pins.h has an output at 20 or 21, where the Mega itself has pull-ups");

_Static_assert(BATTERY_CHANNEL >= 0 && BATTERY_CHANNEL <= 15, "pins.h has the battery at a pin other than A0 to A15");

/* ICRn can be written only after the mode is chosen ("Input Capture Unit"). */
#define START_TIMER(pin) \
    CONTROL(pin) = MODE_A; \
    CONTROL_B(pin) = MODE_B; \
    TOP(pin) = TIMER_COUNTS - 1;

void hal_start_motors(void)
{
    enum { MODE_A = _BV(WGM11), MODE_B = _BV(WGM13) | _BV(WGM12) | PWM_CLOCK };     /* the same bits in each timer */
    /* All outputs have been low since motors_off.S. */
    EACH_PWM_PIN(START_TIMER)
}

#define PULL_UP(pin) SET_HIGH(pin);

static void on_any_edge(uint8_t interrupt)
{
    if (interrupt < 4)
        EICRA |= (uint8_t)(1 << 2 * interrupt);
    else
        EICRB |= (uint8_t)(1 << 2 * (interrupt - 4));
    EIFR = _BV(interrupt);          /* what choosing the edge may have raised */
    EIMSK |= _BV(interrupt);
}

void hal_start_encoders(void)
{
    ENCODER_PINS(PULL_UP)
    on_any_edge(INTERRUPT(ENCODER_0_A));
    on_any_edge(INTERRUPT(ENCODER_1_A));
}

ISR(VECTOR(ENCODER_0_A))
{
    bool b = PIN(ENCODER_0_B) & BIT(ENCODER_0_B), a = PIN(ENCODER_0_A) & BIT(ENCODER_0_A);
    uint8_t counts = TCNT0, ended = TIFR0 & _BV(OCF0A);
    gathered_on_edge(0, a, b, counts, ended);
}

ISR(VECTOR(ENCODER_1_A))
{
    bool b = PIN(ENCODER_1_B) & BIT(ENCODER_1_B), a = PIN(ENCODER_1_A) & BIT(ENCODER_1_A);
    uint8_t counts = TCNT0, ended = TIFR0 & _BV(OCF0A);
    gathered_on_edge(1, a, b, counts, ended);
}

void hal_start_battery(void)
{
    ADMUX = _BV(REFS0) + (BATTERY_CHANNEL & 7);         /* against AVCC */
    ADCSRB = BATTERY_CHANNEL & 8 ? _BV(MUX5) : 0;
    /* 16 MHz / 128 = 125 kHz: all 10 bits need 50 to 200 kHz ("Prescaling and Conversion Timing"). */
    ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
}

uint16_t hal_battery_counts(void)
{
    uint16_t counts = ADC;
    ADCSRA |= _BV(ADSC);            /* takes 104 us; nothing while one is under way */
    return counts;
}
