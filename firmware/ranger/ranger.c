/* The ranger board: a ping each slot, and its result up to the host as soon as it is known; bumpers when asked. */
#include "boot.h"
#include "bumper_protocol.h"
#include "bumpers.h"
#include "clock.h"
#include "firmware.h"
#include "hal.h"
#include "hello.h"
#include "link.h"
#include "protocol.h"
#include "sonars.h"
#include "tick.h"
#include "watchdog.h"

static const struct link_handler handlers[] = {
    { FRAME_HELLO_REQUEST, sizeof(struct hello_request), hello_on_request },
    { FRAME_TICK, sizeof(struct tick), tick_on_frame },
    { FRAME_BUMPER_REQUEST, sizeof(struct bumper_request), bumpers_on_request },
};

static uint32_t slot_ms;
static uint8_t next;            /* the sensor whose slot comes */

static void send_range(uint8_t sensor, const struct sonar_result *result)
{
    struct range range = {
        .type = FRAME_RANGE,
        .seq = link_next_seq(),
        .board_us = result->pinged_us,
        .boot_id = boot_id(),
        .tick_epoch = result->tick.epoch,
        .tick_robot_ns = result->tick.robot_ns,
        .sensor = sensor,
        .state = result->verdict.state,
        .fault = result->verdict.fault,
        .echo_us = result->verdict.echo_us,
        .line_errors = link_errors(),
    };
    link_send(&range, sizeof range);
}

void firmware_setup(void)
{
    boot_start();
    clock_start();
    link_start();
    sonars_start();
    bumpers_start();
    slot_ms = clock_ms();
    watchdog_start();
    hal_enable_interrupts();
    hello_send();
}

void firmware_poll(void)
{
    link_poll(handlers, sizeof handlers / sizeof *handlers);
    for (uint8_t sensor = 0; sensor < RANGE_SENSORS; sensor++) {
        struct sonar_result result;
        if (sonars_result(sensor, &result))
            send_range(sensor, &result);
    }
    if (clock_due(&slot_ms, RANGE_SLOT_MS)) {
        sonars_ping(next);
        next = (uint8_t)((next + 1) % RANGE_SENSORS);
    }
    bumpers_poll();
    watchdog_poll();
}

void firmware_on_millisecond(void)
{
    clock_on_millisecond();
}
