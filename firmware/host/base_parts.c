/* The base board's parts: two H bridges, an encoder on the shaft of each, a battery. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include "encoders.h"
#include "hal_base.h"
#include "machine.h"
#include "protocol.h"

static struct motor {
    /* bridge */
    int forward, connected, counts;
    int duty;                       /* signed, now */
    uint64_t since_ns;              /* it has been so */
    double duty_ns;                 /* its integral over the slice */
    /* encoder */
    double from, to;                /* position at the slice's ends, quadrature states */
    int a, b;                       /* its pins */
    int was_cut;
} motors[BOARD_MOTORS];

static uint64_t slice_from_ns, slice_to_ns;
static uint16_t battery_counts;

static void bridge_changed(int k)
{
    struct motor *m = &motors[k];
    uint64_t now = machine_now_ns();
    m->duty_ns += m->duty * (double)(now - m->since_ns);
    m->since_ns = now;
    m->duty = !m->connected ? 0 : m->forward ? m->counts : -m->counts;
    if (abs(m->duty) > machine_board->motor[k].drive_peak)
        machine_board->motor[k].drive_peak = abs(m->duty);
}

void hal_start_motors(void)
{
}

void hal_motor_off(uint8_t motor)
{
    motors[motor].connected = 0;
    motors[motor].counts = 0;
    bridge_changed(motor);
}

void hal_motor_direction(uint8_t motor, bool forward)
{
    if (motors[motor].connected)
        machine_complain("PHASE turned while PWM was connected");
    motors[motor].forward = forward;
    bridge_changed(motor);
}

void hal_motor_pwm(uint8_t motor, uint8_t counts)
{
    motors[motor].connected = 1;
    motors[motor].counts = counts;
    bridge_changed(motor);
}

/* State s of the quadrature on the pins. Just after A's edge, A != B is forward; encoder 1 is mirrored. */
static void present(int k)
{
    static const int A[4] = { 0, 1, 1, 0 }, B[4] = { 0, 0, 1, 1 };
    struct motor *m = &motors[k];
    int s = (int)(machine_board->motor[k].states & 3);
    bool edge = A[s] != m->a;
    m->a = A[s];
    m->b = B[s] ^ k;
    if (!edge)
        return;
    if (k == 0)
        encoders_on_edge_0(m->a, m->b);
    else
        encoders_on_edge_1(m->a, m->b);
}

/* The position moves evenly from `from` to `to`, and the states are counted up to it: they cannot drift apart. */
static void schedule_edge(int k)
{
    const struct motor *m = &motors[k];
    const struct motor_model *model = &machine_board->motor[k];
    double at;
    if (model->encoder_cut)
        return;
    if (m->to >= (double)(model->states + 1))
        at = (double)(model->states + 1);
    else if (m->to < (double)model->states)
        at = (double)model->states;
    else
        return;
    double part = m->to == m->from ? 0 : (at - m->from) / (m->to - m->from);
    part = fmin(fmax(part, 0), 1);
    machine_schedule(PART_0 + (enum source)k,
                     slice_from_ns + (uint64_t)(part * (double)(slice_to_ns - slice_from_ns)));
}

void parts_on_event(int k)
{
    struct motor_model *model = &machine_board->motor[k];
    model->states += motors[k].to >= (double)(model->states + 1) ? 1 : -1;
    present(k);
    schedule_edge(k);
}

void hal_start_encoders(void)
{
}

static void convert_battery(void)
{
    battery_counts = (uint16_t)fmin(fmax(machine_board->battery_volts / 5 * 1024, 0), 1023);
}

void hal_start_battery(void)
{
    convert_battery();
}

uint16_t hal_battery_counts(void)
{
    uint16_t counts = battery_counts;
    convert_battery();
    return counts;
}

void parts_open(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        motors[k] = (struct motor){ .b = k };
    slice_to_ns = 0;
}

void parts_reset(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        motors[k].connected = motors[k].counts = 0;
        bridge_changed(k);
    }
}

void parts_begin(uint64_t until_ns)
{
    slice_from_ns = machine_now_ns();
    slice_to_ns = until_ns;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct motor *m = &motors[k];
        struct motor_model *model = &machine_board->motor[k];
        m->from = m->to;
        m->to = model->position;
        m->duty_ns = 0;
        m->since_ns = slice_from_ns;
        if (m->was_cut && !model->encoder_cut) {
            model->states = (int64_t)floor(m->from);
            present(k);
        }
        m->was_cut = model->encoder_cut;
        schedule_edge(k);
    }
}

void parts_end(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        bridge_changed(k);
        machine_board->motor[k].drive = motors[k].duty_ns / (double)(slice_to_ns - slice_from_ns);
    }
}
