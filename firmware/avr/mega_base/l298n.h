/* An L298N or a TB6612FNG: each motor has two inputs that choose its direction, and one for PWM. */
#ifndef GIRAFF_L298N_H
#define GIRAFF_L298N_H

#define BOARD_KIND MEGA_L298N_BOARD

#define EACH_PWM_PIN(do) do(MOTOR_0_PWM) do(MOTOR_1_PWM)
#define EACH_OUTPUT(do) EACH_PWM_PIN(do) do(MOTOR_0_IN1) do(MOTOR_0_IN2) do(MOTOR_1_IN1) do(MOTOR_1_IN2) do(ENABLE)

#endif
