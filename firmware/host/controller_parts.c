/* What is at a board that is a process: a motor controller on a serial line, with an encoder on the shaft of each motor. */
#include <math.h>
#include <string.h>
#include "board.h"
#include "machine.h"
#include "controller_model.h"
#include "shafts.h"
#include "system.h"

static const enum source TO_CONTROLLER = PART_2, FROM_CONTROLLER = PART_3;
enum { LINE_SIZE = 256, MS_NS = 1000000, BITS_PER_BYTE = 10 };
enum { TURN_AROUND_US = 1000, MIN_VOLTS = 6, LEVEL_FULL = 255 };

struct way {
    uint8_t bytes[LINE_SIZE];
    unsigned n;
};

static struct controller_model model;
static int has_power;
static struct way there, back;                  /* bytes on the line, either way */
static struct way come;                         /* bytes that wait for the process */
static double duty_from_us;

static double now_us(void)
{
    return (double)machine_now_ns() / 1000;
}

static uint64_t byte_ns(void)
{
    return BITS_PER_BYTE * 1000000000ull / model_baud;
}

static void add(struct way *way, const uint8_t *bytes, unsigned n)
{
    if (n > LINE_SIZE - way->n)
        n = LINE_SIZE - way->n;
    memcpy(way->bytes + way->n, bytes, n);
    way->n += n;
}

static uint8_t first(struct way *way)
{
    uint8_t byte = way->bytes[0];
    memmove(way->bytes, way->bytes + 1, --way->n);
    return byte;
}

void system_line_write(const uint8_t *bytes, uint8_t n)
{
    add(&there, bytes, n);
    if (!machine_is_scheduled(TO_CONTROLLER))
        machine_schedule(TO_CONTROLLER, machine_now_ns() + byte_ns());
}

uint8_t system_line_read(uint8_t *to, uint8_t room)
{
    unsigned n = come.n < room ? come.n : room;
    for (unsigned i = 0; i < n; i++)
        to[i] = first(&come);
    return (uint8_t)n;
}

static void arrived(void)
{
    uint8_t reply[MODEL_REPLY_MAX];
    uint8_t byte = first(&there);
    if (there.n)
        machine_schedule(TO_CONTROLLER, machine_now_ns() + byte_ns());
    if (!has_power || machine_board->driver_line_cut)
        return;
    for (int k = 0; k < MODEL_MOTORS; k++)
        model.edges[k] = machine_board->motor[k].states;
    unsigned n = (unsigned)model_on_byte(&model, byte, now_us(), reply);
    add(&back, reply, n);
    if (n && !machine_is_scheduled(FROM_CONTROLLER))
        machine_schedule(FROM_CONTROLLER, machine_now_ns() + TURN_AROUND_US * 1000ull + byte_ns());
}

static void came_back(void)
{
    uint8_t byte = first(&back);
    if (back.n)
        machine_schedule(FROM_CONTROLLER, machine_now_ns() + byte_ns());
    if (!machine_board->driver_line_cut)
        add(&come, &byte, 1);
}

void parts_on_event(int part)
{
    if (part < BOARD_MOTORS)
        shafts_on_event(part);
    else if (machine_board->driver_line_held)
        machine_schedule((enum source)part, machine_now_ns() + MS_NS);
    else if ((enum source)part == TO_CONTROLLER)
        arrived();
    else
        came_back();
}

/* The controller counts for itself, on all edges of both channels. */
static void present(int k, int a, int b)
{
    (void)k;
    (void)a;
    (void)b;
}

void parts_open(void)
{
    memset(&model, 0, sizeof model);
    has_power = 0;
    there.n = back.n = come.n = 0;
    machine_board->driver_volts = 12;           /* until the world says */
    shafts_open(present);
}

/* The process begins anew: the controller and what is on the line do not. */
void parts_reset(void)
{
    come.n = 0;
}

void parts_begin(uint64_t until_ns)
{
    int has = machine_board->driver_volts >= MIN_VOLTS;
    model.volts = machine_board->driver_volts;
    model.is_pressed = machine_board->cord_pulled;
    if (has != has_power || !has)
        model_power_on(&model, now_us());
    has_power = has;
    memset(model.duty_us, 0, sizeof model.duty_us);
    memset(model.duty_peak, 0, sizeof model.duty_peak);
    duty_from_us = now_us();
    shafts_begin(until_ns);
}

void parts_end(void)
{
    double us = now_us() - duty_from_us;
    model_pass(&model, now_us());
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct motor_model *motor = &machine_board->motor[k];
        motor->drive = LEVEL_FULL * model.duty_us[k] / us / MODEL_FULL;
        int peak = (int)ceil(LEVEL_FULL * model.duty_peak[k] / MODEL_FULL - 0.01);
        if (peak > motor->drive_peak)
            motor->drive_peak = peak;
    }
}
