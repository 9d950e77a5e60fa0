/* The registers of Ardros's board: ATmega2560. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include "board.h"
#include "gathered.h"
#include "hal_base.h"
#include "pins.h"
#include "pulse.h"

/* Timer 3 in fast PWM up to ICR3 (mode 14) at 2 MHz. Datasheet, "Fast PWM Mode": a compare register is taken over as
 * the frame begins, and clears its pin. */
_Static_assert(F_CPU / 8 == PULSE_COUNTS_PER_US * 1000000ul, "a count of the timer is one of pulse.h");
static const uint16_t FRAME = PULSE_FRAME_MS * 1000ul * PULSE_COUNTS_PER_US;

static bool is_forward[2];

static void give_pulse(uint8_t motor, uint16_t width)
{
    uint16_t last = width - 1;      /* count in which the pin is still high */
    if (motor == 0)
        OCR3C = last;
    else
        OCR3B = last;
}

void hal_start_motors(void)
{
    /* The pins have been low outputs since motors_off.S. A compare register is taken over at once before the mode is
     * chosen, and ICR3 can be written only after it ("Input Capture Unit"). */
    hal_motor_off(0);
    hal_motor_off(1);
    TCCR3A = _BV(COM3B1) | _BV(COM3C1) | _BV(WGM31);
    TCCR3B = _BV(WGM33) | _BV(WGM32);
    ICR3 = FRAME - 1;
    TCNT3 = FRAME - 8;              /* the first frame, a neutral one, begins now */
    TCCR3B |= _BV(CS31);
}

/* Neutral, at which the driver brakes; without pulses it would go on at the last one until its time-out. */
void hal_motor_off(uint8_t motor)
{
    give_pulse(motor, PULSE_NEUTRAL);
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    is_forward[motor] = forward;
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    give_pulse(motor, pulse_of(is_forward[motor], counts));
}

void hal_start_encoders(void)
{
    PORTD |= _BV(ENCODER_0_A) | _BV(ENCODER_1_A);       /* pull-ups */
    PORTA |= _BV(ENCODER_0_B) | _BV(ENCODER_1_B);
    EICRA = _BV(ISC20) | _BV(ISC30);                    /* any edge */
    EIFR = _BV(INTF2) | _BV(INTF3);                     /* what choosing the edge may have raised */
    EIMSK = _BV(INT2) | _BV(INT3);
}

ISR(INT2_vect)
{
    bool b = PINA & _BV(ENCODER_0_B), a = PIND & _BV(ENCODER_0_A);
    uint8_t counts = TCNT0, ended = TIFR0 & _BV(OCF0A);
    gathered_on_edge(0, a, b, counts, ended);
}

ISR(INT3_vect)
{
    bool b = PINA & _BV(ENCODER_1_B), a = PIND & _BV(ENCODER_1_A);
    uint8_t counts = TCNT0, ended = TIFR0 & _BV(OCF0A);
    gathered_on_edge(1, a, b, counts, ended);
}

/* One converter for both channels, in turn. */
static bool converts_limit;
static uint16_t battery;
static volatile uint8_t limit;               /* nothing is allowed until it is measured */

static void convert(uint8_t channel)
{
    ADMUX = _BV(REFS0) | (channel & 7);                 /* against AVCC */
    ADCSRB = channel & 8 ? _BV(MUX5) : 0;
    /* 16 MHz / 128 = 125 kHz: all 10 bits need 50 to 200 kHz ("Prescaling and Conversion Timing"). */
    ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
}

void hal_start_battery(void)
{
    PORTF |= _BV(LIMIT_CHANNEL);                        /* pull-up: without a potentiometer nothing is limited */
    DIDR0 = _BV(LIMIT_CHANNEL);
    DIDR2 = _BV(BATTERY_CHANNEL - 8);
    convert(BATTERY_CHANNEL);
}

uint16_t hal_battery_counts(void)
{
    if (ADCSRA & _BV(ADSC))
        return battery;             /* it was asked again at once */
    if (converts_limit)
        limit = (uint8_t)(ADC >> 2);
    else
        battery = ADC;
    converts_limit = !converts_limit;
    convert(converts_limit ? LIMIT_CHANNEL : BATTERY_CHANNEL);     /* takes 104 us */
    return battery;
}

uint8_t hal_level_limit(void)
{
    return limit;
}
