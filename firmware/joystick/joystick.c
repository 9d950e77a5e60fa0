/* The joystick board: the hand's tilt up to the host, 50 times a second. */
#include "bno055.h"
#include "boot.h"
#include "clock.h"
#include "firmware.h"
#include "hal.h"
#include "hal_joystick.h"
#include "hello.h"
#include "link.h"
#include "protocol.h"
#include "tick.h"
#include "watchdog.h"

static const struct link_handler handlers[] = {
    { FRAME_HELLO_REQUEST, sizeof(struct hello_request), hello_on_request },
    { FRAME_TICK, sizeof(struct tick), tick_on_frame },
};

static uint32_t asked_ms;
static uint32_t asked_us;
static struct held_tick asked_tick;     /* held when the reading began: what it measures is not older */
static bool asked;

static void send_tilt(const struct bno055_reading *reading)
{
    struct tilt tilt = {
        .type = FRAME_TILT,
        .seq = link_next_seq(),
        .board_us = asked_us,
        .boot_id = boot_id(),
        .tick_epoch = asked_tick.epoch,
        .tick_robot_ns = asked_tick.robot_ns,
        .x = reading->x,
        .y = reading->y,
        .z = reading->z,
        .status = reading->status,
        .sys_status = reading->sys_status,
        .sys_error = reading->sys_error,
        .button = hal_button(),         /* asked every 20 ms, longer than a contact bounces */
        .line_errors = link_errors(),
    };
    link_send(&tilt, sizeof tilt);
}

void firmware_setup(void)
{
    boot_start();
    clock_start();
    link_start();
    hal_start_joystick();
    asked_ms = clock_ms();
    bno055_start(asked_ms);
    watchdog_start();
    hal_enable_interrupts();
    hello_send();
}

void firmware_poll(void)
{
    link_poll(handlers, sizeof handlers / sizeof *handlers);
    bno055_poll(clock_ms());
    if (clock_due(&asked_ms, TILT_PERIOD_MS)) {
        asked_us = clock_us();
        asked_tick = tick_newest();
        asked = true;
        bno055_ask(clock_ms());
    }
    struct bno055_reading reading;
    if (asked && bno055_answer(&reading)) {
        asked = false;
        send_tilt(&reading);
    }
    watchdog_poll();
}

void firmware_on_millisecond(void)
{
    clock_on_millisecond();
}
