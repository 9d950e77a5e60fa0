/* A base board's parts: an encoder on the shaft of each motor, a battery, a potentiometer. outputs.h has its motors. */
#include <math.h>
#include <stdbool.h>
#include "encoders.h"
#include "hal_base.h"
#include "machine.h"
#include "outputs.h"
#include "protocol.h"

static struct encoder {
    double from, to;                /* position at the slice's ends, quadrature states */
    int a, b;                       /* its pins */
    int was_cut;
} encoders[BOARD_MOTORS];

static uint64_t slice_from_ns, slice_to_ns;
static uint16_t battery_counts, limit_counts;

/* State s of the quadrature on the pins. Just after A's edge, A != B is forward; encoder 1 is mirrored. */
static void present(int k)
{
    static const int A[4] = { 0, 1, 1, 0 }, B[4] = { 0, 0, 1, 1 };
    struct encoder *e = &encoders[k];
    int s = (int)(machine_board->motor[k].states & 3);
    bool edge = A[s] != e->a;
    e->a = A[s];
    e->b = B[s] ^ k;
    if (!edge)
        return;
    if (k == 0)
        encoders_on_edge_0(e->a, e->b);
    else
        encoders_on_edge_1(e->a, e->b);
}

/* The position moves evenly from `from` to `to`, and the states are counted up to it: they cannot drift apart. */
static void schedule_edge(int k)
{
    const struct encoder *e = &encoders[k];
    const struct motor_model *model = &machine_board->motor[k];
    double at;
    if (model->encoder_cut)
        return;
    if (e->to >= (double)(model->states + 1))
        at = (double)(model->states + 1);
    else if (e->to < (double)model->states)
        at = (double)model->states;
    else
        return;
    double part = e->to == e->from ? 0 : (at - e->from) / (e->to - e->from);
    part = fmin(fmax(part, 0), 1);
    machine_schedule(PART_0 + (enum source)k,
                     slice_from_ns + (uint64_t)(part * (double)(slice_to_ns - slice_from_ns)));
}

void parts_on_event(int k)
{
    if (k >= BOARD_MOTORS) {
        outputs_on_event(k);
        return;
    }
    struct motor_model *model = &machine_board->motor[k];
    model->states += encoders[k].to >= (double)(model->states + 1) ? 1 : -1;
    present(k);
    schedule_edge(k);
}

void hal_start_encoders(void)
{
}

static uint16_t converted(double volts)
{
    return (uint16_t)fmin(fmax(volts / 5 * 1024, 0), 1023);
}

void hal_start_battery(void)
{
    battery_counts = converted(machine_board->battery_volts);
    limit_counts = converted(machine_board->limit_volts);
}

uint16_t hal_battery_counts(void)
{
    uint16_t counts = battery_counts;
    hal_start_battery();
    return counts;
}

uint8_t hal_level_limit(void)
{
    return (uint8_t)(limit_counts >> 2);
}

void parts_open(void)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        encoders[k] = (struct encoder){ .b = k };
    slice_to_ns = 0;
    outputs_open();
}

void parts_reset(void)
{
    outputs_reset();
}

void parts_begin(uint64_t until_ns)
{
    slice_from_ns = machine_now_ns();
    slice_to_ns = until_ns;
    outputs_begin();
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct encoder *e = &encoders[k];
        struct motor_model *model = &machine_board->motor[k];
        e->from = e->to;
        e->to = model->position;
        if (e->was_cut && !model->encoder_cut) {
            model->states = (int64_t)floor(e->from);
            present(k);
        }
        e->was_cut = model->encoder_cut;
        schedule_edge(k);
    }
}

void parts_end(void)
{
    outputs_end();
}
