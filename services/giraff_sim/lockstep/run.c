/* Running a core to the end of a slice, and what a reset of it takes to survive. */
#include <string.h>
#include "avr_extint.h"
#include "inside.h"

/* Instructions that run together, up to the next timer or interrupt: the same bytes as one by one, but faster. */
enum { BATCH_CYCLES = 1000 };

static avr_cycle_count_t on_slice_end(avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr;
    (void)param;
    /* TRAP: a sleep that begins in the slice's last instruction would find this timer gone, and run past the end. */
    return when + 1;
}

static void arm(struct board_model *b)      /* what is to happen before the end of the slice */
{
    struct board_private *in = b->inside;
    avr_t *avr = in->avr;
    /* TRAP: sleep jumps to the next timer, so without one it would run past the slice's end. */
    avr_cycle_timer_register(avr, in->end > avr->cycle ? in->end - avr->cycle : 0, on_slice_end, NULL);
    encoders_arm(b);
    uart_arm(b);
}

/* TRAP: avr_reset, a watchdog's included, empties the timer pool, clears PINx and forgets settings. */
static void after_reset(struct board_model *b)
{
    struct board_private *in = b->inside;
    in->was_reset = 0;
    in->avr->run_cycle_limit = BATCH_CYCLES;
    for (uint8_t n = 0; n < EXTINT_COUNT; n++)
        avr_extint_set_strict_lvl_trig(in->avr, n, 0);  /* TRAP: INTn low with EICRx = 0 polls at every cycle */
    pins_restore(in->avr);
    sonars_arm(b);
    bridges_restore(b);
    servos_restore(b);
    twi_restore(b);
    uart_restore(b);
    in->driver_line.tail = in->driver_line.head;
}

static void put_volts(const struct board_private *in, struct analog *analog, double volts)
{
    int parts = (int)(volts * in->parts_per_volt + 0.5);
    if (!analog->input || parts == analog->parts)
        return;
    analog->parts = parts;
    avr_raise_irq(analog->input, (uint32_t)parts);
}

static void inputs(struct board_model *b)
{
    struct board_private *in = b->inside;
    if (in->button.port)
        pin_drive(b, in->button, !b->button);           /* to ground, against a pull-up */
    for (int k = 0; k < BOARD_BUMPERS; k++)
        if (in->bumper[k].port)
            pin_drive(b, in->bumper[k], b->bumper_open[k]); /* closed to ground, or the pull-up */
    put_volts(in, &in->battery, b->battery_volts);
    put_volts(in, &in->limit, b->limit_volts);
    for (int k = 0; k < BOARD_SENSORS; k++)
        put_volts(in, &in->sensor[k], b->sensor_volts[k]);
    if (in->cord.port)
        pin_drive(b, in->cord, !b->cord_pulled);        /* to ground, against a pull-up */
}

static void outputs(struct board_model *b)
{
    const struct board_private *in = b->inside;
    if (in->slave_reset.port)
        b->slave_reset = pin_output(in->avr, in->slave_reset) == 0;
    if (in->enable[0].port)
        b->driver_open = pin_output(in->avr, in->enable[0]) != 1 && pin_output(in->avr, in->enable[1]) != 1;
}

static void run_slice(struct board_model *b)
{
    struct board_private *in = b->inside;
    avr_t *avr = in->avr;
    avr_cycle_count_t began = avr->cycle;
    in->slept = 0;
    encoders_begin(b);
    bridges_begin(b);
    servos_begin(b);
    driver_line_begin(b);
    if (in->was_reset)
        after_reset(b);
    inputs(b);
    arm(b);
    while (avr->cycle < in->end) {
        int state = avr_run(avr);
        if (in->was_reset) {
            after_reset(b);
            arm(b);
        }
        if (state == cpu_Done || state == cpu_Crashed) {
            b->state = state == cpu_Done ? BOARD_STOPPED : BOARD_CRASHED;
            break;
        }
    }
    avr_cycle_count_t cycles = avr->cycle - began;
    bridges_end(b, cycles);
    servos_end(b);
    driver_line_end(b);
    b->awake = cycles ? 1 - (double)in->slept / (double)cycles : 0;
    outputs(b);
}

int board_run(struct board_model *b, uint64_t until_us)
{
    struct board_private *in = b->inside;
    avr_cycle_count_t end = until_us * (uint64_t)in->avr->frequency / 1000000;
    if (end <= in->end)
        return b->state;
    in->start = in->end;
    in->end = end;
    if (b->state == BOARD_RUNNING)
        run_slice(b);
    if (b->state != BOARD_RUNNING) {
        if (in->avr->cycle < end)
            in->avr->cycle = end;       /* time goes on; a reset must not make up for it */
        b->awake = 0;
        encoders_stand_still(b);
        bridges_stand_still(b);
        servos_stand_still(b);
        driver_line_begin(b);
        driver_line_end(b);
    }
    b->now_us = until_us;
    return b->state;
}

void board_reset(struct board_model *b, int cause)
{
    avr_t *avr = b->inside->avr;
    avr_reset(avr);
    if (cause & RESET_POWER_ON)
        memset(avr->data + avr->ioend + 1, 0xC5, (size_t)(avr->ramend - avr->ioend));
    const struct { int cause; avr_regbit_t flag; } flags[] = {
        { RESET_POWER_ON, avr->reset_flags.porf },
        { RESET_EXTERNAL, avr->reset_flags.extrf },
        { RESET_BROWN_OUT, avr->reset_flags.borf },
        { RESET_WATCHDOG, avr->reset_flags.wdrf },
    };
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++)
        if (cause & flags[k].cause)
            avr_regbit_set(avr, flags[k].flag);
    b->state = BOARD_RUNNING;
}
