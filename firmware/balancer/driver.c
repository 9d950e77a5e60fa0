#include "balancer_protocol.h"
#include "driver.h"
#include "hal.h"
#include "hal_balancer.h"

/* The driver's commands, as its maker numbers them. */
enum { BACKWARD = 1, MIN_VOLTS = 2, SECOND_MOTOR = 4, TIMEOUT = 14 };
enum { SETS_BAUD = 170, TIMEOUT_UNIT_MS = 100, MIN_VOLTS_FROM_MV = 6000, MIN_VOLTS_UNIT_MV = 200 };
enum { PACKET = 4, MOST_BYTES = 1 + 4 * PACKET, SETTINGS_PERIODS = 1000 / BALANCE_PERIOD_MS };
_Static_assert(MOST_BYTES * 10000ul / DRIVER_BAUD < BALANCE_PERIOD_MS, "a period's bytes go out within it");

static uint8_t bytes[MOST_BYTES];
static volatile uint8_t n, sent;
static uint16_t cut_off_mv;                     /* 0 = no session has said */
static uint8_t settings_due;                    /* periods until they are sent again */

void driver_start(void)
{
    hal_start_driver();
}

void driver_cut_off_below(uint16_t mv)
{
    cut_off_mv = mv;
    settings_due = 0;
}

static uint8_t put(uint8_t at, uint8_t command, uint8_t value)
{
    bytes[at++] = DRIVER_ADDRESS;
    bytes[at++] = command;
    bytes[at++] = value;
    bytes[at++] = (uint8_t)(DRIVER_ADDRESS + command + value) & 0x7f;
    return at;
}

void driver_send(const int8_t motor[2], bool rests)
{
    if (settings_due)
        settings_due--;
    if (sent < n)
        return;         /* a period that began late: a packet that is cut short would be worse than one that is missing */
    bool settings = rests && !settings_due;
    uint8_t at = 0;
    if (settings)
        bytes[at++] = SETS_BAUD;
    for (uint8_t k = 0; k < 2; k++) {
        int8_t value = motor[k];
        uint8_t command = (uint8_t)((k ? SECOND_MOTOR : 0) + (value < 0 ? BACKWARD : 0));
        at = put(at, command, (uint8_t)(value < 0 ? -value : value));
    }
    if (settings) {
        at = put(at, TIMEOUT, DRIVER_TIMEOUT_MS / TIMEOUT_UNIT_MS);
        if (cut_off_mv)
            at = put(at, MIN_VOLTS, (uint8_t)((cut_off_mv - MIN_VOLTS_FROM_MV) / MIN_VOLTS_UNIT_MV));
        settings_due = SETTINGS_PERIODS;
    }
    ATOMICALLY {
        sent = 0;
        n = at;
        hal_driver_transmit();
    }
}

int16_t driver_on_transmit(void)
{
    if (sent == n)
        return -1;
    return bytes[sent++];
}
