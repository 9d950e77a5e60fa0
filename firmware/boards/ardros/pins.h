/* Pins of Ardros's board (Arduino Mega, ATmega2560); README.md has them as a table. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

/* Outputs of port E: servo pulses to the motor driver. */
#define SERVO_0 5                   /* PE5 = D3 = OC3C */
#define SERVO_1 4                   /* PE4 = D2 = OC3B */

#define ENCODER_0_A 2               /* PD2 = D19 = INT2 */
#define ENCODER_0_B 3               /* PA3 = D25 */
#define ENCODER_1_A 3               /* PD3 = D18 = INT3 */
#define ENCODER_1_B 2               /* PA2 = D24 */

#define BATTERY_CHANNEL 8           /* PK0 = A8 = ADC8 */
#define LIMIT_CHANNEL 0             /* PF0 = A0 = ADC0: the potentiometer */

#endif
