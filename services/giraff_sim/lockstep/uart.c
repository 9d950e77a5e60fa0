/* USART0 as a line of bytes: one arrives every ten bit times of the baud the firmware has set, whether it is
 * ready or not. */
#include <string.h>
#include "inside.h"

avr_uart_t *uart_named(avr_t *avr, char name)
{
    for (avr_io_t *io = io_next(avr, "uart", NULL); io; io = io_next(avr, "uart", io))
        if (((avr_uart_t *)io)->name == name)
            return (avr_uart_t *)io;
    return NULL;
}

avr_cycle_count_t uart_byte_cycles(avr_t *avr, const avr_uart_t *uart)
{
    int ubrr = avr_regbit_get(avr, uart->ubrrl) | avr_regbit_get(avr, uart->ubrrh) << 8;
    int bit_cycles = (ubrr + 1) * (avr_regbit_get(avr, uart->u2x) ? 8 : 16);
    return (avr_cycle_count_t)(10 * bit_cycles);
}

static avr_cycle_count_t byte_cycles(const struct board_private *in)
{
    return uart_byte_cycles(in->avr, in->uart);
}

static void on_transmitted(avr_irq_t *irq, uint32_t value, void *param)
{
    struct board_model *b = param;
    (void)irq;
    b->tx_total++;
    if (b->tx_len < TX_SIZE)
        b->inside->tx[b->tx_len++] = (uint8_t)value;
    else
        b->tx_lost++;
}

static void on_full(avr_irq_t *irq, uint32_t value, void *param)
{
    (void)irq;
    ((struct board_model *)param)->inside->receiver_full = (int)value;
}

static avr_cycle_count_t on_byte_arrived(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct board_model *b = param;
    struct board_private *in = b->inside;
    (void)avr;
    uint8_t byte = in->rx[in->rx_tail];
    in->rx_tail = (in->rx_tail + 1) % RX_SIZE;
    b->rx_free++;
    b->rx_total++;
    if (!in->receiver_full)             /* else it is lost, as on a wire */
        avr_raise_irq(in->uart->io.irq + UART_IRQ_INPUT, byte);
    return in->rx_tail == in->rx_head ? 0 : when + byte_cycles(in);
}

int uart_wire(struct board_model *b)
{
    struct board_private *in = b->inside;
    in->uart = uart_named(in->avr, '0');
    if (!in->uart)
        return -1;
    in->uart->flags = 0;                /* TRAP: else it echoes on stdout, and sleeps in wall-clock time */
    avr_irq_register_notify(in->uart->io.irq + UART_IRQ_OUTPUT, on_transmitted, b);
    avr_irq_register_notify(in->uart->io.irq + UART_IRQ_OUT_XOFF, on_full, b);
    b->rx_free = RX_SIZE - 1;
    return 0;
}

void uart_arm(struct board_model *b)
{
    struct board_private *in = b->inside;
    if (avr_regbit_get(in->avr, in->uart->rxen))
        in->uart->cycles_per_byte = byte_cycles(in);    /* TRAP: simavr counts a parity bit nobody sends */
    if (in->rx_tail != in->rx_head && !avr_cycle_timer_status(in->avr, on_byte_arrived, b))
        avr_cycle_timer_register(in->avr, byte_cycles(in), on_byte_arrived, b);
}

void uart_restore(struct board_model *b)
{
    b->inside->receiver_full = 0;
}

int board_uart_read(struct board_model *b, uint8_t *to, int room)
{
    unsigned n = b->tx_len < (unsigned)room ? b->tx_len : (unsigned)room;
    memcpy(to, b->inside->tx, n);
    b->tx_len -= n;
    memmove(b->inside->tx, b->inside->tx + n, b->tx_len);
    return (int)n;
}

int board_uart_write(struct board_model *b, const uint8_t *from, int n)
{
    struct board_private *in = b->inside;
    int taken = 0;
    for (; taken < n && b->rx_free; taken++, b->rx_free--) {
        in->rx[in->rx_head] = from[taken];
        in->rx_head = (in->rx_head + 1) % RX_SIZE;
    }
    return taken;
}
