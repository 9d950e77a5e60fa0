/* The registers of the balancing robot's board: ATmega2560. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include "board.h"
#include "driver.h"
#include "encoders.h"
#include "hal_balancer.h"
#include "pins.h"
#include "sensors.h"

void hal_start_encoders(void)
{
    PORTB |= ENCODER_PINS;                              /* pull-ups */
    PCMSK0 = ENCODER_PINS;
    PCICR = _BV(PCIE0);
}

uint8_t hal_encoder_pins(void)
{
    return PINB & ENCODER_PINS;
}

ISR(PCINT0_vect)
{
    encoders_on_change(hal_encoder_pins());
}

/* One after the other, without end: 104 us each at 16 MHz / 128 = 125 kHz, since all 10 bits need 50 to 200 kHz
 * ("Prescaling and Conversion Timing"). Against AREF, 3.3 V. */
static void convert(uint8_t sensor)
{
    ADMUX = sensor;
    ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADIE) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);
}

void hal_start_sensors(void)
{
    DIDR0 = SENSOR_PINS;
    convert(0);
}

ISR(ADC_vect)
{
    static const uint8_t ORDER[] = { 0, 1, 2, 3, 0, 1, 2, 3, BATTERY };
    static uint8_t at;
    uint8_t sensor = ORDER[at];
    uint16_t counts = ADC;
    if (++at == sizeof ORDER)
        at = 0;
    convert(ORDER[at]);
    sensors_on_conversion(sensor, counts);
}

void hal_start_driver(void)
{
    UBRR3 = (F_CPU + 8ul * DRIVER_BAUD) / (16ul * DRIVER_BAUD) - 1;    /* 25: 0.2 % fast */
    UCSR3C = _BV(UCSZ31) | _BV(UCSZ30);
    UCSR3B = _BV(TXEN3);
}

void hal_driver_transmit(void)
{
    UCSR3B |= _BV(UDRIE3);
}

ISR(USART3_UDRE_vect)
{
    int16_t byte = driver_on_transmit();
    if (byte < 0)
        UCSR3B &= (uint8_t)~_BV(UDRIE3);
    else
        UDR3 = (uint8_t)byte;
}

void hal_start_cord(void)
{
    PORTA |= _BV(CORD);                                 /* pull-up, as S2 of the motor driver has one */
}

bool hal_cord_is_pulled(void)
{
    return !(PINA & _BV(CORD));
}
