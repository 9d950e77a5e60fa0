/* An L298N or a TB6612FNG: each motor has two inputs that choose its direction, and one for PWM. */
#ifndef GIRAFF_L298N_H
#define GIRAFF_L298N_H

#define BOARD_KIND MEGA_L298N_BOARD

/* 16 MHz / 64 / 510 = 490 Hz, as Arduino's analogWrite. Between two pulses at ENA an L298N lets the motor's current run
 * back into the supply, faster than it rose: at 20 kHz a small level would give no torque. */
#define PWM_CLOCK (_BV(CS11) | _BV(CS10))
#define TIMER_COUNTS_PER_COUNT 2

#define EACH_PWM_PIN(do) do(MOTOR_0_PWM) do(MOTOR_1_PWM)
#define EACH_OUTPUT(do) EACH_PWM_PIN(do) do(MOTOR_0_IN1) do(MOTOR_0_IN2) do(MOTOR_1_IN1) do(MOTOR_1_IN2) do(ENABLE)

#endif
