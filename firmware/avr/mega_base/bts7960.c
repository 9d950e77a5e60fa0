/* Two BTS7960. Off, a bridge is open by its own enable wire: so a shorted PWM input, which gives full power, does it only
 * while that wheel is driven, and the loop that holds its speed takes it off again. */
#include "hal_base.h"
#include "pwm.h"

static bool is_forward[2];

#define TURN_OFF(motor) do { \
    DISCONNECT(motor##_RPWM); \
    DISCONNECT(motor##_LPWM); \
    SET_LOW(motor##_ENABLE); \
} while (0)

#define DRIVE(motor, forward, counts) do { \
    SET_HIGH(motor##_ENABLE); \
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
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    is_forward[motor] = forward;
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    if (motor == 0)
        DRIVE(MOTOR_0, is_forward[0], counts);
    else
        DRIVE(MOTOR_1, is_forward[1], counts);
}
