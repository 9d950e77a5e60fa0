/* A process on a computer runs the program, in simulated time: linux/ has its code, and this what linux/ asks of a kernel. */
#include "process.h"
#include <string.h>
#include "controller.h"
#include "machine.h"
#include "program.h"
#include "protocol.h"
#include "system.h"

enum { MS_NS = 1000000, PORT_SIZE = 4096 };

static uint64_t began_ns;
static uint8_t port[PORT_SIZE];         /* what the host has sent and the process has not read */
static unsigned port_n;

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

/* Its pseudo terminal is a new one. */
void program_start(void)
{
    machine_board->process_stalls = PROCESS_RUNS;
    began_ns = machine_now_ns();
    port_n = 0;
    processor_lose_input();
    machine_schedule(CLOCK, machine_now_ns() + MS_NS);
    process_start();
}

void program_on_clock(void)
{
    machine_schedule(CLOCK, machine_now_ns() + MS_NS);
}

static void reset(int cause)
{
    system_line_write(protocol.stop, protocol.stop_bytes);
    board_reset(machine_board, cause);
}

/* A process that does not run at all hears nothing of its watchdog either. */
void program_on_watchdog(void)
{
    if (machine_board->process_stalls != PROCESS_IS_SUSPENDED)
        reset(RESET_WATCHDOG);
}

void program_on_byte(uint8_t byte)
{
    if (port_n < PORT_SIZE)
        port[port_n++] = byte;
}

void program_after_event(void)
{
    if (machine_board->process_stalls != PROCESS_RUNS)
        return;
    struct ending ending = process_turn();
    if (ending.why)
        reset(ending.cause);
}
