/* Two H bridges: PWM and PHASE. */
#include <stdbool.h>
#include <stdlib.h>
#include "hal_base.h"
#include "machine.h"
#include "outputs.h"

static struct bridge {
    int forward, connected, counts;
    int duty;                       /* signed, now */
    uint64_t since_ns;              /* it has been so */
    double duty_ns;                 /* its integral over the slice */
} bridges[BOARD_MOTORS];

static uint64_t slice_from_ns;

static void changed(int k)
{
    struct bridge *bridge = &bridges[k];
    uint64_t now = machine_now_ns();
    bridge->duty_ns += bridge->duty * (double)(now - bridge->since_ns);
    bridge->since_ns = now;
    bridge->duty = !bridge->connected ? 0 : bridge->forward ? bridge->counts : -bridge->counts;
    if (abs(bridge->duty) > machine_board->motor[k].drive_peak)
        machine_board->motor[k].drive_peak = abs(bridge->duty);
}

void hal_start_motors(void)
{
}

void hal_motor_off(uint8_t motor)
{
    bridges[motor].connected = 0;
    bridges[motor].counts = 0;
    changed(motor);
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    if (bridges[motor].connected)
        machine_complain("PHASE turned while PWM was connected");
    bridges[motor].forward = forward;
    changed(motor);
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    bridges[motor].connected = 1;
    bridges[motor].counts = counts;
    changed(motor);
}

void outputs_open(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        bridges[k] = (struct bridge){ 0 };
}

void outputs_reset(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        bridges[k].connected = bridges[k].counts = 0;
        changed(k);
    }
}

void outputs_begin(void)
{
    slice_from_ns = machine_now_ns();
    for (int k = 0; k < BOARD_MOTORS; k++) {
        bridges[k].duty_ns = 0;
        bridges[k].since_ns = slice_from_ns;
    }
}

void outputs_end(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        changed(k);
        machine_board->motor[k].drive = bridges[k].duty_ns / (double)(machine_now_ns() - slice_from_ns);
    }
}

void outputs_on_event(int part)
{
    (void)part;
}
