/* Servo outputs: pulses of a timer's compare unit in fast PWM, to a motor driver. Their edges come from the unit's own
 * IRQ: the pin's also tells the port register, which the unit overrides. */
#include "inside.h"

static double us(const avr_t *avr)
{
    return (double)avr->cycle * 1e6 / avr->frequency;
}

static int is_connected(avr_t *avr, const struct servo *s)
{
    return pin_output(avr, s->pin) >= 0 && avr_regbit_get(avr, s->compare->com);
}

/* An input gives no pulse: the line has a pull-down. */
static void sample(struct servo *s)
{
    avr_t *avr = s->driver.board->inside->avr;
    servo_driver_pin(&s->driver, is_connected(avr, s) ? s->level : pin_output(avr, s->pin) == 1, us(avr));
}

static void on_register(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    (void)value;
    sample(param);
}

/* TRAP: simavr uses a compare register at once, which cuts or stretches the running pulse, or not at all where only its
 * high byte changes. The processor keeps it until the next frame begins. */
static void on_compare_register(avr_t *avr, avr_io_addr_t address, uint8_t low, void *param)
{
    struct servo *s = param;
    avr_core_watch_write(avr, address, low);
    s->next = (uint16_t)(low | avr->data[s->compare->r_ocrh] << 8);
}

static void on_compare(avr_irq_t *irq, uint32_t level, void *param)
{
    struct servo *s = param;
    (void)irq;
    s->level = (int)level;
    if (level)          /* a frame begins; simavr arms the pulse's end after this */
        s->compare->comp_cycles = s->compare->timer->cs_div_value * (s->next + 1u);
    sample(s);
}

int servo_wire(struct board_model *b, int number, const struct servo_wiring *wiring)
{
    avr_t *avr = b->inside->avr;
    avr_timer_t *timer = timer_named(avr, wiring->timer);
    if (!timer)
        return -1;
    int channel = wiring->channel - 'A';
    struct servo *s = &b->inside->servo[number];
    *s = (struct servo){ .driver = { .board = b, .number = number }, .pin = pin_named(avr, wiring->pin),
                         .compare = &timer->comp[channel] };
    avr_irq_register_notify(&timer->io.irq[TIMER_IRQ_OUT_COMP + channel], on_compare, s);
    avr->io[AVR_DATA_TO_IO(s->compare->r_ocr)].w.c = on_compare_register;
    avr->io[AVR_DATA_TO_IO(s->compare->r_ocr)].w.param = s;
    register_watch(avr, s->compare->com.reg, on_register, s);
    pin_watch(avr, s->pin, on_register, s);
    return 0;
}

void servos_begin(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        if (b->inside->servo[k].driver.board)
            servo_driver_begin(&b->inside->servo[k].driver, us(b->inside->avr));
}

void servos_restore(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct servo *s = &b->inside->servo[k];
        if (!s->driver.board)
            continue;
        s->level = s->next = 0;
        sample(s);
    }
}

void servos_end(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++)
        if (b->inside->servo[k].driver.board)
            servo_driver_end(&b->inside->servo[k].driver, us(b->inside->avr));
}

/* simavr's timers stand with a stopped core. A real one's run on while its program hangs, and in the idle sleep that
 * the firmware uses: the pulses go on as they were, which is also the worse case. */
void servos_stand_still(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct servo *s = &b->inside->servo[k];
        if (!s->driver.board)
            continue;
        if (is_connected(avr, s) && s->compare->timer->cs_div_value)
            servo_driver_repeat(&s->driver, us(avr));
        servo_driver_end(&s->driver, us(avr));
    }
}
