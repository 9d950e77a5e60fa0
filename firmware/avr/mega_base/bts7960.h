/* Two BTS7960 modules, as the IBT-2: each motor has an input for PWM in either direction. */
#ifndef GIRAFF_BTS7960_H
#define GIRAFF_BTS7960_H

#define BOARD_KIND MEGA_BTS7960_BOARD

/* 16 MHz / 765 = 20.9 kHz, which nobody hears; the data sheet allows 25 kHz. Between two pulses the motor is shorted, so that
 * its current goes on. */
#define PWM_CLOCK _BV(CS10)
#define TIMER_COUNTS_PER_COUNT 3

#define EACH_PWM_PIN(do) do(MOTOR_0_RPWM) do(MOTOR_0_LPWM) do(MOTOR_1_RPWM) do(MOTOR_1_LPWM)
#define EACH_OUTPUT(do) EACH_PWM_PIN(do) do(MOTOR_0_ENABLE) do(MOTOR_1_ENABLE)

#endif
