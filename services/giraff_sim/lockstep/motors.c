/* Motors and encoders. The compare and port registers are read, not the values of simavr's PWM IRQs: those are
 * stale after a reset, do not tell a disconnected compare output, and phase-correct PWM has none. */
#include <math.h>
#include <stdlib.h>
#include "inside.h"

enum { COMPARE_CLEAR = 2, COMPARE_SET = 3 };    /* COM bits: non-inverting, inverting */

static int duty_of(avr_t *avr, const struct motor *m)
{
    int output = pin_output(avr, m->pwm);
    if (output < 0)
        return 0;
    switch (avr_regbit_get(avr, m->compare->com)) {
    case COMPARE_CLEAR: return avr->data[m->compare->r_ocr];
    case COMPARE_SET: return 255 - avr->data[m->compare->r_ocr];
    default: return output ? 255 : 0;
    }
}

static void sample(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct motor *m = &b->inside->motor[k];
        if (!m->board)
            continue;
        m->duty_cycles += (int64_t)m->duty * (int64_t)(avr->cycle - m->since);
        m->since = avr->cycle;
        int duty = duty_of(avr, m);
        m->duty = (pin_output(avr, m->phase) == 1) == m->forward ? duty : -duty;
        if (duty > b->motor[k].drive_peak)
            b->motor[k].drive_peak = duty;
    }
}

static void on_register(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)value;
    sample(param);
}

static void watch(struct board_model *b, avr_io_addr_t address)
{
    avr_irq_t *written = avr_iomem_getirq(b->inside->avr, address, NULL, AVR_IOMEM_IRQ_ALL);
    avr_irq_register_notify(written, on_register, b);
}

/* Quadrature state s on the pins: A changes at even-to-odd and odd-to-even steps in turn, A != B just after A's
 * edge is forward, or A == B on a mirrored encoder. */
static void present(struct board_model *b, struct motor *m)
{
    static const uint8_t A[4] = { 0, 1, 1, 0 }, B[4] = { 0, 0, 1, 1 };
    int s = (int)(b->motor[m->number].states & 3);
    pin_drive(b, m->encoder_b, B[s] ^ m->mirrored);
    pin_drive(b, m->encoder_a, A[s]);
}

/* Cycle of the slice's next change of state, 0: none. The position moves linearly from `from` to `to`, so the
 * true position and the count cannot drift apart. */
static avr_cycle_count_t next_edge(const struct board_model *b, const struct motor *m)
{
    const struct motor_model *model = &b->motor[m->number];
    const struct board_private *in = b->inside;
    double step = m->to - m->from, at;
    if (model->encoder_cut)
        return 0;
    if (m->to >= (double)(model->states + 1))
        at = (double)(model->states + 1);
    else if (m->to < (double)model->states)
        at = (double)model->states;
    else
        return 0;
    double part = step == 0 ? 0 : (at - m->from) / step;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    return in->start + (avr_cycle_count_t)(part * (double)(in->end - in->start));
}

static avr_cycle_count_t on_edge(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct motor *m = param;
    struct motor_model *model = &m->board->motor[m->number];
    (void)avr;
    model->states += m->to >= (double)(model->states + 1) ? 1 : -1;
    present(m->board, m);
    avr_cycle_count_t next = next_edge(m->board, m);
    return next && next <= when ? when + 1 : next;
}

static avr_timer_t *timer_named(avr_t *avr, char name)
{
    for (avr_io_t *io = io_next(avr, "timer", NULL); io; io = io_next(avr, "timer", io))
        if (((avr_timer_t *)io)->name == name)
            return (avr_timer_t *)io;
    return NULL;
}

int motor_wire(struct board_model *b, int number, const struct motor_wiring *wiring)
{
    avr_t *avr = b->inside->avr;
    avr_timer_t *timer = timer_named(avr, wiring->timer);
    if (!timer)
        return -1;
    /* TRAP: in phase-correct mode timer 1 counts, wrongly, at every 256th cycle, and its compare output writes
     * PORTD; nothing but its registers matters here. */
    timer->wgm_op[1] = (avr_timer_wgm_t){ .kind = avr_timer_wgm_none };
    struct motor *m = &b->inside->motor[number];
    *m = (struct motor){ .board = b, .number = number, .forward = wiring->forward, .mirrored = wiring->mirrored,
                         .encoder_a = pin_named(avr, wiring->encoder_a),
                         .encoder_b = pin_named(avr, wiring->encoder_b),
                         .pwm = pin_named(avr, wiring->pwm), .phase = pin_named(avr, wiring->phase),
                         .compare = &timer->comp[wiring->channel - 'A'] };
    watch(b, m->compare->r_ocr);
    watch(b, m->compare->com.reg);
    watch(b, m->pwm.port->r_port);
    watch(b, m->pwm.port->r_ddr);
    watch(b, m->phase.port->r_port);
    watch(b, m->phase.port->r_ddr);
    present(b, m);
    return 0;
}

void motors_begin(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct motor *m = &b->inside->motor[k];
        m->from = m->to;
        m->to = b->motor[k].position;
        m->duty_cycles = 0;
        m->since = b->inside->avr->cycle;
        if (m->board && m->was_cut && !b->motor[k].encoder_cut) {
            b->motor[k].states = (int64_t)floor(m->from);
            present(b, m);
        }
        m->was_cut = b->motor[k].encoder_cut;
    }
}

void motors_arm(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct motor *m = &b->inside->motor[k];
        if (!m->board)
            continue;
        avr_cycle_count_t at = next_edge(b, m);
        if (at)
            avr_cycle_timer_register(avr, at > avr->cycle ? at - avr->cycle : 0, on_edge, m);
    }
}

void motors_restore(struct board_model *b)
{
    sample(b);
}

void motors_end(struct board_model *b, avr_cycle_count_t cycles)
{
    sample(b);
    for (int k = 0; k < BOARD_MOTORS; k++) {
        const struct motor *m = &b->inside->motor[k];
        b->motor[k].drive = cycles ? (double)m->duty_cycles / (double)cycles : m->duty;
    }
}

void motors_stand_still(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct motor *m = &b->inside->motor[k];
        if (!m->board)
            continue;
        m->to = b->motor[k].position;
        b->motor[k].states = (int64_t)floor(m->to);
        present(b, m);
        b->motor[k].drive = m->duty;        /* a stopped core's outputs hold */
        if (abs(m->duty) > b->motor[k].drive_peak)
            b->motor[k].drive_peak = abs(m->duty);
    }
}
