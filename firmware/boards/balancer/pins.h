/* Pins of the balancing robot's board (Arduino Mega, ATmega2560); README.md has them as a table. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

/* PB0 = D53 is channel A of encoder 0 and PB1 = D52 its B; PB2 = D51 and PB3 = D50 are those of encoder 1. */
#define ENCODER_PINS 0x0f           /* PCINT0 to PCINT3 */

#define CORD 0                      /* PA0 = D22, on the line to S2 of the motor driver: low = pulled */

/* PF0 to PF4 = A0 to A4, in the order of enum sensor. PJ1 = D14 = TXD3 goes to S1 of the motor driver. */
#define SENSOR_PINS 0x1f

#endif
