/* An L298N, or a TB6612FNG. Off, both direction inputs are low: the bridge is open, whatever PWM does. */
#include "hal_base.h"
#include "pwm.h"

/* STBY of a TB6612FNG is that of both motors. */
static void enable(uint8_t motor, bool drives)
{
    static bool driving[2];
    driving[motor] = drives;
    if (driving[0] || driving[1])
        SET_HIGH(ENABLE);
    else
        SET_LOW(ENABLE);
}

#define TURN_OFF(motor) do { \
    DISCONNECT(motor##_PWM); \
    SET_LOW(motor##_IN1); \
    SET_LOW(motor##_IN2); \
} while (0)

#define CHOOSE(motor, forward) do { \
    if (forward) \
        SET_HIGH(motor##_IN1); \
    else \
        SET_HIGH(motor##_IN2); \
} while (0)

void hal_motor_off(uint8_t motor)
{
    if (motor == 0)
        TURN_OFF(MOTOR_0);
    else
        TURN_OFF(MOTOR_1);
    enable(motor, false);
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    if (motor == 0)
        CHOOSE(MOTOR_0, forward);
    else
        CHOOSE(MOTOR_1, forward);
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    enable(motor, true);
    if (motor == 0)
        CONNECT(MOTOR_0_PWM, counts);
    else
        CONNECT(MOTOR_1_PWM, counts);
}
