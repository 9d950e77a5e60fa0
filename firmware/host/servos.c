/* Two servo outputs of one timer, and the motor driver that they are wired to. */
#include <stdbool.h>
#include "hal_base.h"
#include "machine.h"
#include "outputs.h"
#include "pulse.h"
#include "servo_driver.h"

enum { COUNT_NS = 1000 / PULSE_COUNTS_PER_US };
static const enum source FRAME = PART_2, PULSE_END = PART_3;

static struct servo {
    struct servo_driver driver;
    bool is_forward;
    uint16_t width;                 /* of the next frame's pulse */
} servos[BOARD_MOTORS];

static double now_us(void)
{
    return (double)machine_now_ns() / 1000;
}

void hal_start_motors(void)
{
    hal_motor_off(0);
    hal_motor_off(1);
    machine_schedule(FRAME, machine_now_ns());
}

void hal_motor_off(uint8_t motor)
{
    servos[motor].width = PULSE_NEUTRAL;
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    servos[motor].is_forward = forward;
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    servos[motor].width = pulse_of(servos[motor].is_forward, counts);
}

void outputs_open(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        servos[k] = (struct servo){ .driver = { .board = machine_board, .number = k } };
}

void outputs_reset(void)
{
    machine_cancel(FRAME);
    for (int k = 0; k < BOARD_MOTORS; k++) {
        machine_cancel(PULSE_END + (unsigned)k);
        servo_driver_pin(&servos[k].driver, 0, now_us());
    }
}

void outputs_begin(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        servo_driver_begin(&servos[k].driver, now_us());
}

void outputs_end(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        servo_driver_end(&servos[k].driver, now_us());
}

void outputs_on_event(int part)
{
    if ((enum source)part >= PULSE_END) {
        servo_driver_pin(&servos[part - PART_3].driver, 0, now_us());
        return;
    }
    machine_schedule(FRAME, machine_now_ns() + PULSE_FRAME_MS * 1000000ull);
    for (int k = 0; k < BOARD_MOTORS; k++) {
        servo_driver_pin(&servos[k].driver, 1, now_us());
        machine_schedule(PULSE_END + (unsigned)k, machine_now_ns() + servos[k].width * (uint64_t)COUNT_NS);
    }
}
