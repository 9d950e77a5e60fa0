/* A motor driver that does not let go when it is told to. */
#include <stdint.h>

void __wrap_hal_motor_off(uint8_t motor);

void __wrap_hal_motor_off(uint8_t motor)
{
    (void)motor;
}
