/* H bridges. The compare and port registers are read, not the values of simavr's PWM IRQs: those are stale after a
 * reset, do not tell a disconnected compare output, and phase-correct PWM has none. */
#include <stdlib.h>
#include "inside.h"

enum { COMPARE_CLEAR = 2, COMPARE_SET = 3 };    /* COM bits: non-inverting, inverting */

static int duty_of(avr_t *avr, const struct bridge *h)
{
    int output = pin_output(avr, h->pwm);
    if (output < 0)
        return 0;
    switch (avr_regbit_get(avr, h->compare->com)) {
    case COMPARE_CLEAR: return avr->data[h->compare->r_ocr];
    case COMPARE_SET: return 255 - avr->data[h->compare->r_ocr];
    default: return output ? 255 : 0;
    }
}

static void sample(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct bridge *h = &b->inside->bridge[k];
        if (!h->board)
            continue;
        h->duty_cycles += (int64_t)h->duty * (int64_t)(avr->cycle - h->since);
        h->since = avr->cycle;
        int duty = duty_of(avr, h);
        h->duty = (pin_output(avr, h->phase) == 1) == h->forward ? duty : -duty;
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

int bridge_wire(struct board_model *b, int number, const struct bridge_wiring *wiring)
{
    avr_t *avr = b->inside->avr;
    avr_timer_t *timer = timer_named(avr, wiring->timer);
    if (!timer)
        return -1;
    /* TRAP: in phase-correct mode timer 1 counts, wrongly, at every 256th cycle, and its compare output writes
     * PORTD; nothing but its registers matters here. */
    timer->wgm_op[1] = (avr_timer_wgm_t){ .kind = avr_timer_wgm_none };
    struct bridge *h = &b->inside->bridge[number];
    *h = (struct bridge){ .board = b, .forward = wiring->forward, .pwm = pin_named(avr, wiring->pwm),
                          .phase = pin_named(avr, wiring->phase), .compare = &timer->comp[wiring->channel - 'A'] };
    register_watch(avr, h->compare->r_ocr, on_register, b);
    register_watch(avr, h->compare->com.reg, on_register, b);
    pin_watch(avr, h->pwm, on_register, b);
    pin_watch(avr, h->phase, on_register, b);
    return 0;
}

void bridges_begin(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct bridge *h = &b->inside->bridge[k];
        h->duty_cycles = 0;
        h->since = b->inside->avr->cycle;
    }
}

void bridges_restore(struct board_model *b)
{
    sample(b);
}

void bridges_end(struct board_model *b, avr_cycle_count_t cycles)
{
    sample(b);
    for (int k = 0; k < BOARD_MOTORS; k++) {
        const struct bridge *h = &b->inside->bridge[k];
        if (h->board)
            b->motor[k].drive = cycles ? (double)h->duty_cycles / (double)cycles : h->duty;
    }
}

void bridges_stand_still(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        const struct bridge *h = &b->inside->bridge[k];
        if (!h->board)
            continue;
        b->motor[k].drive = h->duty;        /* a stopped core's outputs hold */
        if (abs(h->duty) > b->motor[k].drive_peak)
            b->motor[k].drive_peak = abs(h->duty);
    }
}
