/* What each processor has: watchdog, EEPROM, UART. program.h has how it runs its program. */
#include <stddef.h>
#include <string.h>
#include "board.h"
#include "hal.h"
#include "machine.h"
#include "program.h"
#include "uart.h"

#define EXPORT __attribute__((visibility("default")))

enum { MS_NS = 1000000, BITS_PER_BYTE = 10, TX_SIZE = 65536, RX_SIZE = 4096, EEPROM_SIZE = 4096 };

static const uint64_t BYTE_NS = BITS_PER_BYTE * 1000000000ull / BAUD;

static uint8_t sending;                         /* the byte on its way out */
static uint8_t tx[TX_SIZE];                     /* what has come out; tx_len of the model counts it */
static uint8_t rx[RX_SIZE];
static unsigned rx_len;
static uint8_t eeprom[EEPROM_SIZE];
static int reset_cause;                         /* of the reset before the program's start */

void processor_open(void)
{
    memset(eeprom, 0xFF, sizeof eeprom);        /* as delivered: erased */
    rx_len = 0;
    machine_board->rx_free = RX_SIZE;
}

void processor_lose_input(void)
{
    machine_board->rx_free += rx_len;
    rx_len = 0;
    machine_cancel(UART_RX);
}

void processor_reset(int cause)
{
    reset_cause = cause;
    for (enum source source = WATCHDOG; source < SOURCES; source++)
        machine_cancel(source);
}

static void send_next(void)
{
    int16_t byte = uart_on_transmit();
    if (byte < 0)
        return;
    sending = (uint8_t)byte;
    machine_schedule(UART_TX, machine_now_ns() + BYTE_NS);
}

static void sent(void)
{
    struct board_model *b = machine_board;
    b->tx_total++;
    if (b->tx_len < TX_SIZE)
        tx[b->tx_len++] = sending;
    else
        b->tx_lost++;
    send_next();
}

static void receive_next(void)
{
    if (rx_len && !machine_is_scheduled(UART_RX))
        machine_schedule(UART_RX, machine_now_ns() + BYTE_NS);
}

static void received(void)
{
    uint8_t byte = rx[0];
    memmove(rx, rx + 1, --rx_len);
    machine_board->rx_free++;
    machine_board->rx_total++;
    program_on_byte(byte);
    receive_next();
}

void processor_on_event(enum source source)
{
    switch (source) {
    case CLOCK:
        program_on_clock();
        break;
    case UART_RX:
        received();
        break;
    default:
        sent();
    }
}

EXPORT int board_uart_read(struct board_model *b, uint8_t *to, int room)
{
    unsigned n = room < 0 ? 0 : (unsigned)room;
    if (n > b->tx_len)
        n = b->tx_len;
    memcpy(to, tx, n);
    b->tx_len -= n;
    memmove(tx, tx + n, b->tx_len);
    return (int)n;
}

EXPORT int board_uart_write(struct board_model *b, const uint8_t *from, int n)
{
    unsigned taken = n < 0 ? 0 : (unsigned)n;
    if (taken > b->rx_free)
        taken = b->rx_free;
    memcpy(rx + rx_len, from, taken);
    rx_len += taken;
    b->rx_free -= taken;
    receive_next();
    return (int)taken;
}

EXPORT int board_eeprom(struct board_model *b, uint8_t *bytes, int n, int write)
{
    (void)b;
    if (n < 0 || n > EEPROM_SIZE)
        return -1;
    if (write)
        memcpy(eeprom, bytes, (size_t)n);
    else
        memcpy(bytes, eeprom, (size_t)n);
    return 0;
}

uint8_t hal_take_reset_cause(void)
{
    return (uint8_t)reset_cause;
}

/* As the AVR's compiler lays it out: low byte first, and no gaps. */
_Static_assert(offsetof(struct kept, boot_count) == 0 && offsetof(struct kept, latch) == 4, "as on the AVR");

uint32_t hal_boot_count(void)
{
    return eeprom[0] | (uint32_t)eeprom[1] << 8 | (uint32_t)eeprom[2] << 16 | (uint32_t)eeprom[3] << 24;
}

void hal_set_boot_count(uint32_t count)
{
    for (int i = 0; i < 4; i++)
        eeprom[i] = (uint8_t)(count >> 8 * i);
}

uint8_t hal_kept_latch(uint8_t cell)
{
    return eeprom[offsetof(struct kept, latch) + cell];
}

bool hal_eeprom_is_ready(void)
{
    return true;
}

void hal_keep_latch(uint8_t cell, uint8_t value)
{
    eeprom[offsetof(struct kept, latch) + cell] = value;
}

void hal_start_watchdog(void)
{
    machine_schedule(WATCHDOG, machine_now_ns() + WATCHDOG_MS * (uint64_t)MS_NS);
}

void hal_feed_watchdog(void)
{
    if (machine_is_scheduled(WATCHDOG))
        hal_start_watchdog();
}

void hal_start_uart(void)
{
    receive_next();
}

void hal_transmit(void)
{
    if (!machine_is_scheduled(UART_TX))
        send_next();
}
