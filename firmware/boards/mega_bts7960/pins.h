/* Pins of a Mega with two BTS7960, by the numbers that are printed on the Mega; README.md has them as a table. None of
 * its outputs is one of mega_l298n: the wrong program of the two moves nothing. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

/* R_EN and L_EN of a module are one wire. */
#define MOTOR_0_RPWM 2
#define MOTOR_0_LPWM 3
#define MOTOR_0_ENABLE 4
#define MOTOR_1_ENABLE 44
#define MOTOR_1_RPWM 45
#define MOTOR_1_LPWM 46

#define ENCODER_0_A 18
#define ENCODER_0_B 16
#define ENCODER_1_A 19
#define ENCODER_1_B 17

#define BATTERY_CHANNEL 0           /* A0 */

#endif
