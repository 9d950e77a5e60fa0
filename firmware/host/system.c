/* What linux/process.c asks of a kernel, in simulated time; controller_parts.c has the line to the controller. */
#include "system.h"
#include <string.h>
#include "machine.h"
#include "program.h"

enum { MS_NS = 1000000, PORT_SIZE = 4096 };

static uint64_t began_ns;
static uint8_t port[PORT_SIZE];         /* what the host has sent and the process has not read */
static unsigned port_n;

/* Its pseudo terminal is a new one. */
void system_start(void)
{
    began_ns = machine_now_ns();
    port_n = 0;
    machine_schedule(CLOCK, machine_now_ns() + MS_NS);
}

uint64_t system_ns(void)
{
    return machine_now_ns() - began_ns;
}

uint8_t system_port_read(uint8_t *to, uint8_t room)
{
    uint8_t n = (uint8_t)(port_n < room ? port_n : room);
    memcpy(to, port, n);
    port_n -= n;
    memmove(port, port + n, port_n);
    return n;
}

void program_on_clock(void)
{
    machine_schedule(CLOCK, machine_now_ns() + MS_NS);
}

void program_on_byte(uint8_t byte)
{
    if (port_n < PORT_SIZE)
        port[port_n++] = byte;
}
