/* The base board's registers: ATmega644. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include "encoders.h"
#include "hal_base.h"
#include "pins.h"
#include "transitions.h"

/* Phase-correct PWM, 8 bit, undivided: 18.432 MHz / 510 = 36.1 kHz, below the A3959's 50 kHz. Datasheet, timers
 * 1 and 2, "Modes of Operation": the compare registers are taken over at the counter's top.
 * COM bits of the motors' compare outputs: clear when counting up, set when counting down. */
enum {
    A_CONNECTED = _BV(COM2B1),
    B_CONNECTED = _BV(COM1B1),
};

void hal_start_motors(void)
{
    /* The PWM pins have been low outputs since motors_off.S. */
    DDRC |= _BV(MOTOR_A_PHASE);
    DDRB |= _BV(MOTOR_B_PHASE);
    TCCR2A = _BV(WGM20);
    TCCR2B = _BV(CS20);
    TCCR1A = _BV(WGM10);
    TCCR1B = _BV(CS10);
}

/* Disconnected, a pin follows its PORT bit, low, at once. The compare register is buffered until the counter's
 * top, 28 us at most: cleared now, it is zero long before PWM is connected again. */
void hal_motor_off(uint8_t motor)
{
    if (motor == 0) {
        TCCR2A &= (uint8_t)~A_CONNECTED;
        OCR2B = 0;
    } else {
        TCCR1A &= (uint8_t)~B_CONNECTED;
        OCR1B = 0;
    }
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    if (motor == 0) {
        if (forward)
            PORTC |= _BV(MOTOR_A_PHASE);
        else
            PORTC &= (uint8_t)~_BV(MOTOR_A_PHASE);
    } else {
        if (forward)
            PORTB &= (uint8_t)~_BV(MOTOR_B_PHASE);
        else
            PORTB |= _BV(MOTOR_B_PHASE);
    }
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    if (motor == 0) {
        OCR2B = counts;
        TCCR2A |= A_CONNECTED;
    } else {
        OCR1B = counts;
        TCCR1A |= B_CONNECTED;
    }
}

void hal_start_encoders(void)
{
    PORTD |= _BV(ENCODER_0_A) | _BV(ENCODER_1_A);       /* pull-ups */
    PORTC |= _BV(ENCODER_0_B) | _BV(ENCODER_1_B);
    EICRA = _BV(ISC10) | _BV(ISC00);                    /* any edge */
    EIFR = _BV(INTF1) | _BV(INTF0);                     /* what choosing the edge may have raised */
    EIMSK = _BV(INT1) | _BV(INT0);
}

ISR(INT1_vect)
{
    encoders_on_edge_0(PIND & _BV(ENCODER_0_A), PINC & _BV(ENCODER_0_B));
}

ISR(INT0_vect)
{
    encoders_on_edge_1(PIND & _BV(ENCODER_1_A), PINC & _BV(ENCODER_1_B));
}

/* Counting goes on as it does: channel A has its interrupt for that, and this one beside it, which comes after that.
 * Pin changes 16 to 23 are port C's, and 24 to 31 port D's ("Pin Change Interrupt 3..0"). */
void hal_watch_encoder(uint8_t encoder)
{
    PCICR = 0;
    PCMSK2 = encoder == 0 ? _BV(ENCODER_0_B) : encoder == 1 ? _BV(ENCODER_1_B) : 0;
    PCMSK3 = encoder == 0 ? _BV(ENCODER_0_A) : encoder == 1 ? _BV(ENCODER_1_A) : 0;
    PCIFR = _BV(PCIF3) | _BV(PCIF2);                    /* a change before now */
    if (PCMSK3)
        PCICR = _BV(PCIE3) | _BV(PCIE2);
}

ISR(PCINT3_vect)
{
    uint8_t d = PIND, c = PINC;
    if (PCMSK3 & _BV(ENCODER_0_A))
        transitions_on_change(d & _BV(ENCODER_0_A), c & _BV(ENCODER_0_B));
    else
        transitions_on_change(d & _BV(ENCODER_1_A), c & _BV(ENCODER_1_B));
}

ISR(PCINT2_vect, ISR_ALIASOF(PCINT3_vect));

void hal_start_battery(void)
{
    ADMUX = _BV(REFS0) | BATTERY_CHANNEL;               /* against AVCC */
    DIDR0 = _BV(BATTERY_CHANNEL);
    /* 18.432 MHz / 128 = 144 kHz: all 10 bits need 50 to 200 kHz ("Prescaling and Conversion Timing"). */
    ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
}

uint16_t hal_battery_counts(void)
{
    uint16_t counts = ADC;
    ADCSRA |= _BV(ADSC);            /* takes 90 us; nothing while one is under way */
    return counts;
}
