/* H bridges. The compare and port registers are read, not the values of simavr's PWM IRQs: those are stale after a
 * reset, do not tell a disconnected compare output, and phase-correct PWM has none. */
#include <stdlib.h>
#include "inside.h"

enum { COMPARE_CLEAR = 2, COMPARE_SET = 3 };    /* COM bits: non-inverting, inverting */
enum { FULL = 255 };
enum { PHASE_CORRECT_8_BIT = 1, FAST_UP_TO_ICR = 14 };      /* modes of a timer */

int a3959_drive(const int *levels)
{
    return levels[1] ? levels[0] : -levels[0];
}

int a3959_drive_mirrored(const int *levels)
{
    return -a3959_drive(levels);
}

int l298n_drive(const int *levels)
{
    return (levels[1] != 0) == (levels[2] != 0) ? 0 : a3959_drive(levels);
}

int bts7960_drive(const int *levels)
{
    return levels[2] && levels[3] ? levels[0] - levels[1] : 0;
}

static int is_up_to_icr(avr_t *avr, avr_timer_t *timer)
{
    enum { BITS = sizeof timer->wgm / sizeof *timer->wgm };
    return avr_regbit_get_array(avr, timer->wgm, BITS) == FAST_UP_TO_ICR;
}

/* Of 255, rounded up: no pulse is too short to be seen. */
static int level_of(avr_t *avr, const struct bridge_input *input)
{
    int mode = input->compare ? avr_regbit_get(avr, input->compare->com) : 0;
    if (mode != COMPARE_CLEAR && mode != COMPARE_SET)
        return pin_output(avr, input->pin) ? FULL : 0;
    int width = input->width & 0xff, period = FULL;
    if (is_up_to_icr(avr, input->compare->timer)) {
        period = input->top + 1;
        width = input->width < input->top ? input->width + 1 : period;
    }
    return ((mode == COMPARE_SET ? period - width : width) * FULL + period - 1) / period;
}

static int duty_of(avr_t *avr, const struct bridge *h)
{
    int levels[BRIDGE_INPUTS];
    for (int k = 0; k < BRIDGE_INPUTS; k++) {
        if (h->motor->inputs_high >> k & 1)
            levels[k] = FULL;
        else if (!h->input[k].pin.port || h->motor->inputs_low >> k & 1)
            levels[k] = 0;
        else if (pin_output(avr, h->input[k].pin) < 0)
            levels[k] = h->motor->inputs_float >> k & 1 ? FULL : 0;
        else
            levels[k] = level_of(avr, &h->input[k]);
    }
    return h->drive(levels);
}

static void sample(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct bridge *h = &b->inside->bridge[k];
        if (!h->motor)
            continue;
        h->duty_cycles += (int64_t)h->duty * (int64_t)(avr->cycle - h->since);
        h->since = avr->cycle;
        h->duty = duty_of(avr, h);
        if (abs(h->duty) > h->motor->drive_peak)
            h->motor->drive_peak = abs(h->duty);
    }
}

static void on_register(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)value;
    sample(param);
}

/* Its high byte waits for this, the low one. */
static void on_compare_register(avr_irq_t *irq, uint32_t low, void *param)
{
    struct bridge_input *input = param;
    avr_t *avr = input->pin.port->io.avr;
    (void)irq;
    input->width = (uint16_t)(low | (input->compare->r_ocrh ? avr->data[input->compare->r_ocrh] << 8 : 0));
    sample(board_of(avr));
}

/* TRAP: simavr takes ICR in every mode, the chip only in one whose top it is ("Input Capture Unit"). */
static void on_top_register(avr_irq_t *irq, uint32_t low, void *param)
{
    struct bridge_input *input = param;
    avr_timer_t *timer = input->compare->timer;
    avr_t *avr = timer->io.avr;
    (void)irq;
    if (!is_up_to_icr(avr, timer))
        return;
    input->top = (uint16_t)(low | avr->data[timer->r_icrh] << 8);
    sample(board_of(avr));
}

static avr_timer_comp_t *compare_at(avr_t *avr, struct pin pin)
{
    for (avr_io_t *io = io_next(avr, "timer", NULL); io; io = io_next(avr, "timer", io))
        for (int channel = 0; channel < AVR_TIMER_COMP_COUNT; channel++) {
            avr_timer_comp_t *compare = &((avr_timer_t *)io)->comp[channel];
            if (compare->r_ocr && compare->com_pin.reg == pin.port->r_port && compare->com_pin.bit == pin.bit)
                return compare;
        }
    return NULL;
}

static void input_wire(struct board_model *b, struct bridge_input *input, const char *pin)
{
    avr_t *avr = b->inside->avr;
    *input = (struct bridge_input){ .pin = pin_named(avr, pin) };
    pin_watch(avr, input->pin, on_register, b);
    input->compare = compare_at(avr, input->pin);
    if (!input->compare)
        return;
    avr_timer_t *timer = input->compare->timer;
    /* TRAP: in phase-correct mode timer 1 counts, wrongly, at every 256th cycle, and its compare output writes PORTD;
     * up to ICR it has three events a period. Nothing but its registers matters here. */
    timer->wgm_op[PHASE_CORRECT_8_BIT] = timer->wgm_op[FAST_UP_TO_ICR] =
        (avr_timer_wgm_t){ .kind = avr_timer_wgm_none };
    register_watch(avr, input->compare->r_ocr, on_compare_register, input);
    register_watch(avr, input->compare->com.reg, on_register, b);
    if (timer->r_icr)
        register_watch(avr, timer->r_icr, on_top_register, input);
}

void bridge_wire(struct board_model *b, int number, const struct bridge_wiring *wiring)
{
    struct bridge *h = &b->inside->bridge[number];
    h->motor = &b->motor[number];
    h->drive = wiring->drive;
    for (int k = 0; k < BRIDGE_INPUTS && wiring->pins[k]; k++)
        input_wire(b, &h->input[k], wiring->pins[k]);
}

void bridges_begin(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct bridge *h = &b->inside->bridge[k];
        if (!h->motor)
            continue;
        h->duty = duty_of(b->inside->avr, h);       /* the world may have changed a fault */
        h->duty_cycles = 0;
        h->since = b->inside->avr->cycle;
    }
}

void bridges_restore(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        for (int n = 0; n < BRIDGE_INPUTS; n++)
            b->inside->bridge[k].input[n].width = b->inside->bridge[k].input[n].top = 0;
    sample(b);
}

void bridges_end(struct board_model *b, avr_cycle_count_t cycles)
{
    sample(b);
    for (int k = 0; k < BOARD_MOTORS; k++) {
        const struct bridge *h = &b->inside->bridge[k];
        if (h->motor)
            h->motor->drive = cycles ? (double)h->duty_cycles / (double)cycles : h->duty;
    }
}

void bridges_stand_still(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct bridge *h = &b->inside->bridge[k];
        if (!h->motor)
            continue;
        h->duty = duty_of(b->inside->avr, h);
        h->motor->drive = h->duty;          /* a stopped core's outputs hold */
        if (abs(h->duty) > h->motor->drive_peak)
            h->motor->drive_peak = abs(h->duty);
    }
}
