#include "process.h"
#include <stdbool.h>
#include <stddef.h>
#include "firmware.h"
#include "hal.h"
#include "protocol.h"
#include "system.h"
#include "ticks.h"
#include "uart.h"

enum { MS_NS = 1000000 };

static bool is_set_up;
static uint64_t turned_ns;              /* the newest turn */

static uint32_t now_ms(void)
{
    return (uint32_t)(system_ns() / MS_NS);
}

void process_start(const struct protocol *of_controller)
{
    turned_ns = system_ns();
    controller_start(of_controller, now_ms());
}

static void run_due_milliseconds(void)
{
    while (ticks_take_due())
        firmware_on_millisecond();
}

static void take_from_line(void)
{
    uint8_t bytes[64];
    uint8_t n = system_line_read(bytes, sizeof bytes);
    for (uint8_t i = 0; i < n; i++)
        controller_on_byte(bytes[i], now_ms());
}

/* Less than the firmware's ring holds: each part is handled before the next one. */
static void take_from_port(void)
{
    uint8_t bytes[64];
    uint8_t n = system_port_read(bytes, sizeof bytes);
    for (uint8_t i = 0; i < n; i++)
        uart_on_receive(bytes[i], false);
    firmware_poll();
}

/* No board is there before its controller has proved what it is. Setting up may write to a slow card. */
static void set_up(void)
{
    is_set_up = true;
    firmware_setup();
    turned_ns = system_ns();
    controller_begin(now_ms());
}

/* The clock goes first: what waited while the process did not run is judged by the time that it is. */
struct ending process_turn(void)
{
    uint64_t now_ns = system_ns();
    if (now_ns - turned_ns > WATCHDOG_MS * (uint64_t)MS_NS)
        return (struct ending){ RESET_WATCHDOG, "the board did not run for 250 ms" };
    turned_ns = now_ns;
    run_due_milliseconds();
    take_from_line();
    controller_turn(now_ms());
    if (controller_lost())
        return (struct ending){ RESET_EXTERNAL, controller_lost() };
    if (!is_set_up && controller_is_proved())
        set_up();
    if (is_set_up)
        take_from_port();
    return (struct ending){ 0, NULL };
}

uint64_t process_due_ns(void)
{
    return ticks_due_ns() ? ticks_due_ns() : turned_ns + MS_NS;
}
