/* The base board: wheels and battery up to the host, levels down to the motors. */
#include "boot.h"
#include "clock.h"
#include "drive.h"
#include "encoders.h"
#include "firmware.h"
#include "hal.h"
#include "hal_base.h"
#include "hello.h"
#include "link.h"
#include "motors.h"
#include "transitions.h"
#include "transitions_protocol.h"
#include "watchdog.h"

static uint32_t wheels_sent_ms;

static void on_configure(const void *body)
{
    drive_on_configure(body, boot_id(), clock_ms());
}

static void on_drive(const void *body)
{
    drive_on_levels(body, boot_id(), clock_ms());
}

static void on_speed(const void *body)
{
    drive_on_speeds(body, boot_id(), clock_ms());
}

static void on_estop(const void *body)
{
    drive_on_estop(body, boot_id(), clock_ms());
}

static const struct link_handler handlers[] = {
    { FRAME_HELLO_REQUEST, sizeof(struct hello_request), hello_on_request },
    { FRAME_CONFIGURE, sizeof(struct configure), on_configure },
    { FRAME_DRIVE, sizeof(struct drive), on_drive },
    { FRAME_SPEED, sizeof(struct speed), on_speed },
    { FRAME_ESTOP, sizeof(struct estop), on_estop },
#if HAS_TRANSITIONS
    { FRAME_TRANSITIONS_REQUEST, sizeof(struct transitions_request), transitions_on_request },
#endif
};

static int16_t wheel_pwm(uint8_t wiring, enum wheel wheel)
{
    return wiring_level(wiring, wheel, motors_level(wiring_motor(wiring, wheel)));
}

static void send_wheels(void)
{
    uint8_t wiring = drive_wiring();
    struct drive_report report = drive_report();
    struct encoders_reading read = encoders_read();
    uint16_t battery = hal_battery_counts();
    drive_on_battery(battery);
    struct wheels wheels = {
        .type = FRAME_WHEELS,
        .seq = link_next_seq(),
        .board_us = read.at_us,
        .board_ms = clock_ms(),
        .boot_id = boot_id(),
        .session = report.session,
        .left_ticks = wiring_ticks(wiring, LEFT, read.counts[wiring_encoder(wiring, LEFT)]),
        .right_ticks = wiring_ticks(wiring, RIGHT, read.counts[wiring_encoder(wiring, RIGHT)]),
        .left_pwm_counts = wheel_pwm(wiring, LEFT),
        .right_pwm_counts = wheel_pwm(wiring, RIGHT),
        .drive_state = report.drive_state,
        .latch = report.latch,
        .last_refusal = report.last_refusal,
        .accepted = report.accepted,
        .refused = report.refused,
        .line_errors = link_errors(),
        .battery_adc_counts = battery,
        .left_um_s = report.um_s[LEFT],
        .right_um_s = report.um_s[RIGHT],
        .speed_flags = report.speed_flags,
    };
    link_send(&wheels, sizeof wheels);
}

void firmware_setup(void)
{
    motors_start();
    boot_start();
    drive_start();
    clock_start();
    link_start();
    encoders_start();
    hal_start_battery();
    wheels_sent_ms = clock_ms();
    watchdog_start();
    hal_enable_interrupts();
    hello_send();
}

void firmware_poll(void)
{
    link_poll(handlers, sizeof handlers / sizeof *handlers);
    if (clock_due(&wheels_sent_ms, WHEELS_PERIOD_MS))
        send_wheels();
    if (HAS_TRANSITIONS)
        transitions_poll();
    watchdog_poll();
}

void firmware_on_millisecond(void)
{
    encoders_on_millisecond();
    clock_on_millisecond();
    hal_enable_interrupts();        /* the encoders' edges do not wait for the rest; the next millisecond is far */
    const struct encoders_edge newest[2] = { encoders_newest(0), encoders_newest(1) };
    uint16_t now;
    ATOMICALLY {                    /* after the edges: one newer than now would count as silent for a second */
        now = encoders_until();
    }
    drive_on_millisecond(newest, now);
    motors_on_millisecond(0, drive_level(0));
    motors_on_millisecond(1, drive_level(1));
}
