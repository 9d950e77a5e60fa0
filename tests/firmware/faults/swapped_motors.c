/* A board that takes its left motor for its right one. */
#include <stdbool.h>
#include <stdint.h>

void __real_hal_motor_pwm(uint8_t motor, uint8_t level);
void __real_hal_motor_direction(uint8_t motor, bool forward);
void __real_hal_motor_off(uint8_t motor);
void __wrap_hal_motor_pwm(uint8_t motor, uint8_t level);
void __wrap_hal_motor_direction(uint8_t motor, bool forward);
void __wrap_hal_motor_off(uint8_t motor);

void __wrap_hal_motor_pwm(uint8_t motor, uint8_t level)
{
    __real_hal_motor_pwm(1 - motor, level);
}

void __wrap_hal_motor_direction(uint8_t motor, bool forward)
{
    __real_hal_motor_direction(1 - motor, forward);
}

void __wrap_hal_motor_off(uint8_t motor)
{
    __real_hal_motor_off(1 - motor);
}
