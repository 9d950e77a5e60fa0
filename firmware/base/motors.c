#include "hal.h"
#include "hal_base.h"
#include "motors.h"

static volatile int16_t given[2];

void motors_start(void)
{
    hal_start_motors();
}

int16_t motors_level(uint8_t motor)
{
    int16_t level;
    ATOMICALLY {
        level = given[motor];
    }
    return level;
}

void motors_on_millisecond(uint8_t motor, int16_t wanted)
{
    int16_t now = given[motor];
    if ((now > 0 && wanted < 0) || (now < 0 && wanted > 0))
        wanted = 0;         /* PHASE turns only after a millisecond without PWM */
    if (wanted == now)
        return;
    given[motor] = wanted;
    if (!wanted) {
        hal_motor_off(motor);
        return;
    }
    if (!now)
        hal_motor_direction(motor, wanted > 0);
    hal_motor_pwm(motor, (uint8_t)(wanted < 0 ? -wanted : wanted));
}
