/* A base board's parts: an encoder on the shaft of each motor, a battery, a potentiometer. outputs.h has its motors. */
#include <math.h>
#include "board.h"
#include "encoders.h"
#include "hal_base.h"
#include "machine.h"
#include "outputs.h"
#include "protocol.h"
#include "shafts.h"
#include "transitions.h"
#include "transitions_protocol.h"

static int channel_a[BOARD_MOTORS], channel_b[BOARD_MOTORS];
static uint8_t watched;
static uint16_t battery_counts, limit_counts;

/* Just after A's edge, A != B is forward; encoder 1 is mirrored. */
static void present(int k, int a, int b)
{
    if (HAS_TRANSITIONS && k == watched && (a != channel_a[k] || b != channel_b[k]))
        transitions_on_change(a, k == 0 ? b : !b);
    channel_b[k] = b;
    if (a == channel_a[k])
        return;
    channel_a[k] = a;
    if (k == 0)
        encoders_on_edge_0(a, b);
    else
        encoders_on_edge_1(a, !b);
}

void parts_on_event(int k)
{
    if (k < BOARD_MOTORS)
        shafts_on_event(k);
    else
        outputs_on_event(k);
}

void hal_start_encoders(void)
{
}

void hal_watch_encoder(uint8_t encoder)
{
    watched = encoder;
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
        channel_a[k] = channel_b[k] = 0;
    shafts_open(present);
    outputs_open();
}

void parts_reset(void)
{
    watched = TRANSITIONS_OF_NONE;
    outputs_reset();
}

void parts_begin(uint64_t until_ns)
{
    outputs_begin();
    shafts_begin(until_ns);
}

void parts_end(void)
{
    outputs_end();
}
