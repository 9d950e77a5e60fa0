#include "duty.h"
#include "hal_base.h"

enum { LEVEL_MAX = 255, SUMS_MAX = 250 };
_Static_assert(INT32_MAX / LEVEL_MAX / SUMS_MAX >= CONTROLLER_FULL, "a mean does not overflow");

static bool is_forward[CONTROLLER_MOTORS];
static int16_t wanted[CONTROLLER_MOTORS];       /* levels */
static int32_t sum[CONTROLLER_MOTORS];          /* of those wanted in each millisecond since the newest command */
static uint8_t sums;
static bool drives[CONTROLLER_MOTORS];          /* by the newest command, as far as anybody knows */

void duty_on_millisecond(void)
{
    if (sums == SUMS_MAX)
        return;
    for (uint8_t motor = 0; motor < CONTROLLER_MOTORS; motor++)
        sum[motor] += wanted[motor];
    sums++;
}

void duty_take(int16_t duty[CONTROLLER_MOTORS], bool none)
{
    for (uint8_t motor = 0; motor < CONTROLLER_MOTORS; motor++) {
        int32_t mean = sums ? sum[motor] * CONTROLLER_FULL / LEVEL_MAX / sums : wanted[motor] * CONTROLLER_FULL / LEVEL_MAX;
        duty[motor] = (int16_t)(wanted[motor] && !none ? mean : 0);
        drives[motor] = duty[motor] != 0;
        sum[motor] = 0;
    }
    sums = 0;
}

void duty_forget(void)
{
    for (uint8_t motor = 0; motor < CONTROLLER_MOTORS; motor++)
        drives[motor] = true;
}

bool duty_must_stop(void)
{
    return (!wanted[0] && drives[0]) || (!wanted[1] && drives[1]);
}

void hal_start_motors(void)
{
}

void hal_motor_off(uint8_t motor)
{
    wanted[motor] = 0;
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    is_forward[motor] = forward;
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    wanted[motor] = is_forward[motor] ? counts : (int16_t)-counts;
}

/* Nothing limits it. */
uint8_t hal_level_limit(void)
{
    return LEVEL_MAX;
}
