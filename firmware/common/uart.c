#include "hal.h"
#include "uart.h"

enum { RING_SIZE = 128, RING_MASK = RING_SIZE - 1 };

struct ring {
    volatile uint8_t bytes[RING_SIZE];
    volatile uint8_t head;      /* where the next byte goes in; equal to tail when empty */
    volatile uint8_t tail;
};

static struct ring rx, tx;
static volatile uint16_t lost;

uint8_t uart_room(void)
{
    return (uint8_t)(tx.tail - tx.head - 1) & RING_MASK;
}

bool uart_send(const uint8_t *bytes, uint8_t n)
{
    uint8_t head = tx.head;
    if (n > uart_room())
        return false;
    while (n--) {
        tx.bytes[head] = *bytes++;
        head = (uint8_t)(head + 1) & RING_MASK;
    }
    tx.head = head;
    hal_transmit();
    return true;
}

int16_t uart_receive(void)
{
    uint8_t tail = rx.tail;
    if (tail == rx.head)
        return -1;
    uint8_t byte = rx.bytes[tail];
    rx.tail = (uint8_t)(tail + 1) & RING_MASK;
    return byte;
}

uint16_t uart_lost(void)
{
    uint16_t n;
    ATOMICALLY {
        n = lost;
    }
    return n;
}

void uart_on_receive(uint8_t byte, bool damaged)
{
    uint8_t head = rx.head;
    uint8_t next = (uint8_t)(head + 1) & RING_MASK;
    bool full = next == rx.tail;
    if (damaged || full)
        lost++;
    if (full)
        return;
    rx.bytes[head] = byte;      /* a damaged one too: it belongs to a frame, whose CRC will tell */
    rx.head = next;
}

int16_t uart_on_transmit(void)
{
    uint8_t tail = tx.tail;
    if (tail == tx.head)
        return -1;
    tx.tail = (uint8_t)(tail + 1) & RING_MASK;
    return tx.bytes[tail];
}
