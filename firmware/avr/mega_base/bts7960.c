/* Two BTS7960. An input without PWM is low: both low is a brake, and with ENABLE low the bridge is open. */
#include "hal_base.h"
#include "pwm.h"

static bool is_forward[2];

#define TURN_OFF(motor) do { \
    DISCONNECT(motor##_RPWM); \
    DISCONNECT(motor##_LPWM); \
} while (0)

#define DRIVE(motor, forward, counts) do { \
    if (forward) \
        CONNECT(motor##_RPWM, counts); \
    else \
        CONNECT(motor##_LPWM, counts); \
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
    is_forward[motor] = forward;
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    enable(motor, true);
    if (motor == 0)
        DRIVE(MOTOR_0, is_forward[0], counts);
    else
        DRIVE(MOTOR_1, is_forward[1], counts);
}
