/* A motor driver that gives three times what it is asked for. */
#include <stdint.h>

void __real_hal_motor_pwm(uint8_t motor, uint8_t level);
void __wrap_hal_motor_pwm(uint8_t motor, uint8_t level);

void __wrap_hal_motor_pwm(uint8_t motor, uint8_t level)
{
    __real_hal_motor_pwm(motor, level > 85 ? 255 : (uint8_t)(3 * level));
}
