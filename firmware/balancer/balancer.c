/* The board of a robot that balances: readings and asks in, motor commands out, each control period. */
#include "balance.h"
#include "boot.h"
#include "clock.h"
#include "command.h"
#include "driver.h"
#include "encoders.h"
#include "firmware.h"
#include "hal.h"
#include "hal_balancer.h"
#include "hello.h"
#include "latch.h"
#include "link.h"
#include "sensors.h"
#include "watchdog.h"
#include "wiring.h"

static uint32_t period_ms;                      /* when the newest control period was due, */
static uint32_t period_us;                      /* and when it began */
static uint16_t late;
static bool reports;                            /* each second period */
static int32_t counts[2];                       /* by wheel */
static float volts;
static bool cord_pulled;

static void on_configure(const void *body)
{
    command_on_configure(body, boot_id(), clock_ms());
}

static void on_drive(const void *body)
{
    command_on_drive(body, boot_id(), clock_ms());
}

static void on_estop(const void *body)
{
    command_on_estop(body, boot_id(), clock_ms());
}

static const struct link_handler handlers[] = {
    { FRAME_HELLO_REQUEST, sizeof(struct hello_request), hello_on_request },
    { FRAME_BALANCE_CONFIGURE, sizeof(struct balance_configure), on_configure },
    { FRAME_BALANCE_DRIVE, sizeof(struct balance_drive), on_drive },
    { FRAME_BALANCE_ESTOP, sizeof(struct balance_estop), on_estop },
};

static void count_wheels(uint8_t wiring)
{
    int16_t moved[2];
    encoders_take(moved);
    for (uint8_t wheel = 0; wheel < 2; wheel++) {
        int32_t by = wiring_ticks(wiring, wheel, (uint32_t)(int32_t)moved[wiring_encoder(wiring, wheel)]);
        counts[wheel] = (int32_t)((uint32_t)counts[wheel] + (uint32_t)by);
    }
}

static void control(void)
{
    const struct balance_configure *session = command_session();
    float means[SENSORS];
    sensors_take(means);
    count_wheels(session->wiring);
    volts = means[BATTERY] * (float)session->battery_uv_count * 1e-6f;
    cord_pulled = hal_cord_is_pulled();
    if (cord_pulled)
        command_on_cord();
    struct balance_readings readings = {
        .gyro = { means[GYROSCOPE_0], means[GYROSCOPE_1] },
        .forward = means[FORWARD],
        .up = means[UP],
        .counts = { counts[LEFT], counts[RIGHT] },
        .volts = volts,
        .cord_pulled = cord_pulled,
    };
    struct balance_order order = command_order(balance_state(), clock_ms());
    balance_step(&readings, &order);
    const struct balance_state *state = balance_state();
    int8_t motor[2];
    for (uint8_t wheel = 0; wheel < 2; wheel++)
        motor[wiring_motor(session->wiring, wheel)] =
            (int8_t)wiring_level(session->wiring, wheel, state->command[wheel]);
    driver_send(motor, state->posture == BALANCE_OFF);
}

static int32_t whole(float value, float scale)
{
    const float most = 2147483520.0f;           /* the largest one below 2^31 */
    float scaled = value * scale;
    if (!(scaled > -most))
        return (int32_t)-most;
    return (int32_t)(scaled < most ? scaled : most);
}

/* An encoder is between motor and chassis, so that the chassis' lean is no travel. */
static int32_t on_the_floor(enum wheel wheel, const struct balance_state *state)
{
    float turn = (float)command_session()->counts_per_turn * 0.15915494f;       /* counts for each rad */
    return (int32_t)((uint32_t)counts[wheel] + (uint32_t)whole(state->lean, turn));
}

static void send_report(void)
{
    const struct balance_state *state = balance_state();
    const float micro = 1e6f, milli = 1e3f;
    int32_t mv = whole(volts, milli);
    struct balance report = {
        .type = FRAME_BALANCE,
        .seq = link_next_seq(),
        .board_us = period_us,
        .board_ms = clock_ms(),
        .boot_id = boot_id(),
        .left_counts = on_the_floor(LEFT, state),
        .right_counts = on_the_floor(RIGHT, state),
        .lean_urad = whole(state->lean, micro),
        .rate_urad_s = whole(state->rate, micro),
        .accelerometer_urad = whole(state->accelerometer, micro),
        .trim_urad = whole(state->trim, micro),
        .speed_um_s = whole(state->speed, micro),
        .turn_urad_s = whole(state->turn, micro),
        .torque_mnm = whole(state->torque, milli),
        .left_command = state->command[LEFT],
        .right_command = state->command[RIGHT],
        .battery_mv = (uint16_t)(mv < UINT16_MAX ? mv : UINT16_MAX),
        .late = late,
        .posture = state->posture,
        .cause = state->cause,
        .flags = state->flags | (cord_pulled ? BALANCE_CORD : 0),
        .line_errors = link_errors(),
    };
    command_report(&report);
    link_send(&report, sizeof report);
}

/* Periods that were missed are not made up for: the next step would know nothing new. */
static bool period_begins(void)
{
    uint32_t behind_ms = clock_ms() - period_ms;
    if (behind_ms < BALANCE_PERIOD_MS)
        return false;
    if (behind_ms > BALANCE_PERIOD_MS)
        late++;
    period_ms += behind_ms - behind_ms % BALANCE_PERIOD_MS;
    period_us = clock_us();
    return true;
}

void firmware_setup(void)
{
    hal_start_cord();
    boot_start();
    command_start();
    balance_start();
    clock_start();
    link_start();
    encoders_start();
    hal_start_sensors();
    driver_start();
    period_ms = clock_ms();
    watchdog_start();
    const int8_t zeros[2] = { 0, 0 };
    driver_send(zeros, true);
    hal_enable_interrupts();
    hello_send();
}

void firmware_poll(void)
{
    link_poll(handlers, sizeof handlers / sizeof *handlers);
    if (period_begins()) {
        control();
        reports = !reports;
        if (reports)
            send_report();
    }
    watchdog_poll();
}

void firmware_on_millisecond(void)
{
    clock_on_millisecond();
    latch_on_millisecond();
}
