/* A microcontroller's timer, which interrupts it each millisecond. */
#include "board.h"
#include "clock.h"
#include "firmware.h"
#include "hal.h"
#include "machine.h"
#include "program.h"
#include "uart.h"

enum { MS_NS = 1000000 };

static uint64_t millisecond_began_ns;

void program_on_clock(void)
{
    millisecond_began_ns += MS_NS;
    machine_schedule(CLOCK, millisecond_began_ns + MS_NS);
    firmware_on_millisecond();
}

void program_on_byte(uint8_t byte)
{
    uart_on_receive(byte, false);
}

void hal_enable_interrupts(void)
{
    /* Events come between polls, so none has come yet. */
}

void hal_start_clock(void)
{
    millisecond_began_ns = machine_now_ns();
    machine_schedule(CLOCK, millisecond_began_ns + MS_NS);
}

static uint16_t clock_counts(void)
{
    uint64_t since_ns = machine_now_ns() - millisecond_began_ns;
    return (uint16_t)(since_ns * CLOCK_COUNTS_PER_MS / MS_NS);
}

uint8_t hal_clock_stamps(void)
{
    return CLOCK_STAMPS(clock_counts());
}

uint16_t hal_clock_us(void)
{
    return CLOCK_US(clock_counts());
}
