/* Pins of a Mega with an L298N or a TB6612FNG, by the numbers that are printed on the Mega; README.md has them as a
 * table. None of its outputs is one of mega_bts7960: the wrong program of the two moves nothing. */
#ifndef GIRAFF_PINS_H
#define GIRAFF_PINS_H

/* In the order of the L298N's own terminals: ENA, IN1, IN2, IN3, IN4, ENB. */
#define MOTOR_0_PWM 6
#define MOTOR_0_IN1 7
#define MOTOR_0_IN2 8
#define MOTOR_1_IN1 9
#define MOTOR_1_IN2 10
#define MOTOR_1_PWM 11
#define ENABLE 22                   /* STBY of a TB6612FNG; an L298N has none */

#define ENCODER_0_A 18
#define ENCODER_0_B 16
#define ENCODER_1_A 19
#define ENCODER_1_B 17

#define BATTERY_CHANNEL 0           /* A0 */

#endif
