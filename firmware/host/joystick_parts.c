/* The joystick board's parts: a slave of 256 registers on the two-wire bus, its reset line, a button. */
#include <string.h>
#include "hal_joystick.h"
#include "machine.h"
#include "protocol.h"

enum { BUS_BYTE_NS = 90000 };       /* 9 bits at 100 kHz */

static struct {
    enum bus_state state;
    int byte;                       /* on the bus now, of the transaction */
    uint8_t address, reg, value;
    uint8_t *to;                    /* NULL: it writes */
    int n;
} bus;

static void begin(uint8_t address, uint8_t reg)
{
    bus.state = BUS_BUSY;
    bus.byte = 0;
    bus.address = address;
    bus.reg = reg;
    machine_schedule(PART_0, machine_now_ns() + BUS_BYTE_NS);
}

void hal_bus_read(uint8_t address, uint8_t reg, uint8_t *to, uint8_t n)
{
    bus.to = to;
    bus.n = n;
    begin(address, reg);
}

void hal_bus_write(uint8_t address, uint8_t reg, uint8_t value)
{
    bus.to = NULL;
    bus.value = value;
    begin(address, reg);
}

enum bus_state hal_bus_state(void)
{
    return bus.state;
}

void hal_bus_abort(void)
{
    machine_cancel(PART_0);
    bus.state = BUS_FAILED;
}

/* The registers' values of one instant, as the device keeps those of a burst together. */
static void latch(void)
{
    for (int i = 0; i < bus.n; i++)
        bus.to[i] = machine_board->twi_register[(uint8_t)(bus.reg + i)];
    machine_board->twi_reads += (uint64_t)bus.n;
}

/* A byte has gone over: address, register, and then the value, or address and values. */
void parts_on_event(int part)
{
    int byte = bus.byte++;
    (void)part;
    if (machine_board->twi_address != bus.address) {
        bus.state = BUS_FAILED;
        return;
    }
    if (bus.to && byte == 2)
        latch();
    if (!bus.to && byte == 2)
        machine_board->twi_register[bus.reg] = bus.value;
    if (byte == (bus.to ? 2 + bus.n : 2))
        bus.state = BUS_DONE;
    else
        machine_schedule(PART_0, machine_now_ns() + BUS_BYTE_NS);
}

void hal_start_joystick(void)
{
}

void hal_hold_sensor_in_reset(bool hold)
{
    machine_board->slave_reset = hold;
}

bool hal_button(void)
{
    return machine_board->button;
}

void parts_open(void)
{
}

void parts_reset(void)
{
    machine_cancel(PART_0);
    bus.state = BUS_DONE;
    machine_board->slave_reset = 0;
}

void parts_begin(uint64_t until_ns)
{
    (void)until_ns;
}

void parts_end(void)
{
}
