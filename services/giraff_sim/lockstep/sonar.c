/* HC-SR04: a trigger pulse of 10 us, silence while the burst goes out, then the echo pulse. */
#include "inside.h"

enum { BURST_US = 450, TRIGGER_MIN_US = 9 };

static avr_cycle_count_t cycles(const avr_t *avr, double us)
{
    return (avr_cycle_count_t)(us * avr->frequency / 1e6);
}

static avr_cycle_count_t on_echo(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct sonar *s = param;
    struct board_model *b = s->board;
    (void)when;
    if (s->state == SONAR_ECHOING) {
        s->state = SONAR_IDLE;
        pin_drive(b, s->echo, 0);
        return 0;
    }
    double echo_us = b->on_ping ? b->on_ping(b->user, s->number) : 0;
    if (echo_us == 0) {
        s->state = SONAR_IDLE;
        pin_drive(b, s->echo, 0);       /* it may have been stuck */
        return 0;
    }
    pin_drive(b, s->echo, 1);
    s->state = echo_us < 0 ? SONAR_STUCK : SONAR_ECHOING;
    s->due = avr->cycle + cycles(avr, echo_us < 0 ? 0 : echo_us);
    return s->state == SONAR_ECHOING ? s->due : 0;
}

static void on_trigger(avr_irq_t *irq, uint32_t value, void *param)
{
    struct sonar *s = param;
    avr_t *avr = s->board->inside->avr;
    int level = pin_output(avr, s->trigger) == 1;
    (void)irq;
    (void)value;
    if (level == s->trigger_level)
        return;
    s->trigger_level = level;
    if (level) {
        s->trigger_rose = avr->cycle;
        return;
    }
    /* A sensor that still listens does not hear its trigger. One whose line is stuck is asked again, so that a
     * mended one comes back: its line falls at the end of that echo. */
    int deaf = s->state == SONAR_PINGED || s->state == SONAR_ECHOING;
    if (deaf || avr->cycle - s->trigger_rose < cycles(avr, TRIGGER_MIN_US))
        return;
    s->board->pings[s->number]++;
    s->state = SONAR_PINGED;
    s->due = avr->cycle + cycles(avr, BURST_US);
    avr_cycle_timer_register(avr, s->due - avr->cycle, on_echo, s);
}

void sonar_wire(struct board_model *b, int number, const char *trigger, const char *echo)
{
    struct sonar *s = &b->inside->sonar[number];
    avr_t *avr = b->inside->avr;
    *s = (struct sonar){ .board = b, .number = number };
    s->trigger = pin_named(avr, trigger);
    s->echo = pin_named(avr, echo);
    pin_drive(b, s->echo, 0);
    const avr_io_addr_t watched[] = { s->trigger.port->r_port, s->trigger.port->r_ddr };
    for (size_t k = 0; k < sizeof watched / sizeof *watched; k++)
        avr_irq_register_notify(avr_iomem_getirq(avr, watched[k], NULL, AVR_IOMEM_IRQ_ALL), on_trigger, s);
}

void sonars_arm(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_SONARS; k++) {
        struct sonar *s = &b->inside->sonar[k];
        if (!s->board)
            continue;
        s->trigger_level = pin_output(avr, s->trigger) == 1;
        if (s->state == SONAR_PINGED || s->state == SONAR_ECHOING)
            avr_cycle_timer_register(avr, s->due > avr->cycle ? s->due - avr->cycle : 0, on_echo, s);
    }
}
