/* A serial line to a motor driver: it hears a byte when its last bit has come. A reset loses what was on its way. */
#include "inside.h"

static double us(const avr_t *avr)
{
    return (double)avr->cycle * 1e6 / avr->frequency;
}

static avr_cycle_count_t on_byte(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct driver_line *line = param;
    sabertooth_byte(&line->driver, line->bytes[line->tail++ % DRIVER_BYTES], us(avr));
    return line->tail == line->head ? 0 : when + uart_byte_cycles(avr, line->uart);
}

/* The next byte may be written before the one before it has gone, as on the chip. */
static void on_transmitted(avr_irq_t *irq, uint32_t value, void *param)
{
    struct driver_line *line = param;
    avr_t *avr = line->driver.board->inside->avr;
    (void)irq;
    line->bytes[line->head++ % DRIVER_BYTES] = (uint8_t)value;
    line->uart->cycles_per_byte = uart_byte_cycles(avr, line->uart);        /* TRAP: simavr counts a parity bit */
    if (!avr_cycle_timer_status(avr, on_byte, line))
        avr_cycle_timer_register(avr, line->uart->cycles_per_byte, on_byte, line);
}

int driver_line_wire(struct board_model *b, char uart)
{
    struct driver_line *line = &b->inside->driver_line;
    line->uart = uart_named(b->inside->avr, uart);
    if (!line->uart)
        return -1;
    line->driver.board = b;
    line->uart->flags = 0;              /* TRAP: else it echoes on stdout, and sleeps in wall-clock time */
    avr_irq_register_notify(line->uart->io.irq + UART_IRQ_OUTPUT, on_transmitted, line);
    return 0;
}

void driver_line_begin(struct board_model *b)
{
    struct driver_line *line = &b->inside->driver_line;
    if (line->uart)
        sabertooth_begin(&line->driver, us(b->inside->avr));
}

void driver_line_end(struct board_model *b)
{
    struct driver_line *line = &b->inside->driver_line;
    if (line->uart)
        sabertooth_end(&line->driver, us(b->inside->avr));
}
