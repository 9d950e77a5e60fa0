/* A motor driver that gives three times what it is asked for. Only a base board has it: in the others the call is weak. */
#include <stdint.h>

__attribute__((weak)) void __real_hal_motor_pwm(uint8_t motor, uint8_t level);
void __wrap_hal_motor_pwm(uint8_t motor, uint8_t level);

void __wrap_hal_motor_pwm(uint8_t motor, uint8_t level)
{
    __real_hal_motor_pwm(motor, level > 85 ? 255 : (uint8_t)(3 * level));
}
