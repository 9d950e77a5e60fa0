/* The two-wire bus as a master that reads and writes registers, all by interrupts.
 * ATmega328P datasheet, "2-wire Serial Interface", "Transmission Modes". */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/twi.h>
#include "hal.h"
#include "hal_joystick.h"
#include "twi.h"

enum { BUS_HZ = 100000 };

/* Writing TWINT as one lets the hardware go on, with what the other bits say. */
enum {
    GO = _BV(TWINT) | _BV(TWEN) | _BV(TWIE),
    START = GO | _BV(TWSTA),
    STOP = _BV(TWINT) | _BV(TWEN) | _BV(TWSTO),
    TAKE_LAST = GO,
    TAKE_MORE = GO | _BV(TWEA),
};

static volatile uint8_t state;      /* enum bus_state */

/* The transaction under way. */
static uint8_t slave;
static uint8_t output[2];           /* the register's number, and what is written to it */
static uint8_t outputs;             /* 1 to read, 2 to write */
static uint8_t sent;
static uint8_t *input;
static uint8_t inputs;              /* still to come */

void twi_start(void)
{
    TWBR = (uint8_t)((F_CPU / BUS_HZ - 16) / 2);        /* prescaler 1 ("Bit Rate Generator Unit") */
    TWCR = _BV(TWEN);
}

static void send(uint8_t byte)
{
    TWDR = byte;
    TWCR = GO;
}

static void take_next(void)
{
    TWCR = inputs > 1 ? TAKE_MORE : TAKE_LAST;
}

static void end(enum bus_state how)
{
    TWCR = STOP;
    state = (uint8_t)how;
}

ISR(TWI_vect)
{
    switch (TW_STATUS) {
    case TW_START:
        send((uint8_t)(slave << 1 | TW_WRITE));
        break;
    case TW_REP_START:
        send((uint8_t)(slave << 1 | TW_READ));
        break;
    case TW_MT_SLA_ACK:             /* simavr 1.6 has either status for both */
    case TW_MT_DATA_ACK:
        if (sent < outputs)
            send(output[sent++]);
        else if (inputs)
            TWCR = START;
        else
            end(BUS_DONE);
        break;
    case TW_MR_SLA_ACK:
        take_next();
        break;
    case TW_MR_DATA_ACK:
        *input++ = TWDR;
        inputs--;
        take_next();
        break;
    case TW_MR_DATA_NACK:           /* the one that was to be the last */
        *input = TWDR;
        end(BUS_DONE);
        break;
    default:                        /* no answer, or somebody disturbs */
        end(BUS_FAILED);
    }
}

static void begin(uint8_t address)
{
    slave = address;
    sent = 0;
    state = BUS_BUSY;
    TWCR = START;
}

void hal_bus_read(uint8_t address, uint8_t reg, uint8_t *to, uint8_t n)
{
    output[0] = reg;
    outputs = 1;
    input = to;
    inputs = n;
    begin(address);
}

void hal_bus_write(uint8_t address, uint8_t reg, uint8_t value)
{
    output[0] = reg;
    output[1] = value;
    outputs = 2;
    inputs = 0;
    begin(address);
}

enum bus_state hal_bus_state(void)
{
    bool stopping = TWCR & _BV(TWSTO);      /* until the stop condition is out, no other may begin */
    return stopping ? BUS_BUSY : (enum bus_state)state;
}

void hal_bus_abort(void)
{
    ATOMICALLY {
        TWCR = 0;
        TWCR = _BV(TWEN);
        state = BUS_FAILED;
    }
}
