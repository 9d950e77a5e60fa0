/* The ranger board's parts: three HC-SR04, two bumpers. */
#include "hal_ranger.h"
#include "machine.h"
#include "protocol.h"
#include "sonars.h"

enum { BURST_NS = 450000 };         /* from the trigger to the echo line's rise */

static struct sonar {
    enum { IDLE, PINGED, ECHOING, STUCK, RELEASED } state;
    bool line;
} sonars[BOARD_SONARS];

static void set_line(int k, bool high)
{
    sonars[k].line = high;
    sonars_on_edge((uint8_t)k, high);
}

static void after(int k, double us)
{
    machine_schedule(PART_0 + (enum source)k, machine_now_ns() + (uint64_t)(us * 1000));
}

/* A sensor that still listens does not hear its trigger; one whose line is stuck is asked again. */
void hal_trigger(uint8_t k)
{
    if (sonars[k].state == PINGED || sonars[k].state == ECHOING)
        return;
    machine_board->pings[k]++;
    sonars[k].state = sonars[k].line ? RELEASED : PINGED;
    machine_schedule(PART_0 + (enum source)k, machine_now_ns() + (sonars[k].line ? 0 : BURST_NS));
}

static void ping(int k)
{
    double echo_us = machine_board->on_ping ? machine_board->on_ping(machine_board->user, k) : 0;
    sonars[k].state = echo_us == 0 ? IDLE : echo_us < 0 ? STUCK : ECHOING;
    if (sonars[k].state == IDLE)
        return;
    set_line(k, true);
    if (sonars[k].state == ECHOING)
        after(k, echo_us);
}

void parts_on_event(int k)
{
    switch (sonars[k].state) {
    case PINGED:
        ping(k);
        break;
    case ECHOING:
        sonars[k].state = IDLE;
        set_line(k, false);
        break;
    default:                        /* RELEASED */
        sonars[k].state = PINGED;
        set_line(k, false);
        after(k, BURST_NS / 1000.0);
    }
}

bool hal_echo_line(uint8_t sensor)
{
    return sonars[sensor].line;
}

void hal_start_sonars(void)
{
}

void hal_start_bumpers(void)
{
}

bool hal_bumper_is_open(uint8_t bumper)
{
    return machine_board->bumper_open[bumper];
}

void parts_open(void)
{
    for (int k = 0; k < BOARD_SONARS; k++)
        sonars[k] = (struct sonar){ IDLE, false };
}

void parts_reset(void)
{
}

void parts_begin(uint64_t until_ns)
{
    (void)until_ns;
}

void parts_end(void)
{
}
