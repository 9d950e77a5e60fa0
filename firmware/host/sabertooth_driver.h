/* A motor driver on a serial line, as the simulated world has it: two copies of it for both simulators of a board. Bytes
 * of packets go in, a duty for each motor comes out. Zero brakes. What its maker publishes and our facts have: a byte
 * sets the baud once, settings are lost with the power, a packet with a wrong sum is ignored.
 *
 * The board's side calls sabertooth_byte when a byte has come over the line, and begin and end around each slice. Times
 * are simulated microseconds and never go back.
 */
#ifndef GIRAFF_SABERTOOTH_DRIVER_H
#define GIRAFF_SABERTOOTH_DRIVER_H
#include <math.h>
#include <stdint.h>
#include <string.h>
#include "board_model.h"

enum { SABERTOOTH_ADDRESS = 128, SABERTOOTH_SETS_BAUD = 170, SABERTOOTH_PACKET = 4, SABERTOOTH_FULL = 127 };
enum { SABERTOOTH_MIN_VOLTS = 2, SABERTOOTH_TIMEOUT = 14 };

struct sabertooth_driver {
    struct board_model *board;          /* NULL: the board has none */
    uint8_t packet[SABERTOOTH_PACKET];
    int n;                              /* bytes of it that have come */
    double volts_min, timeout_us;       /* as its settings have them; 0 = no time-out */
    double heard_us;                    /* when the newest good packet had come */
    int command[BOARD_MOTORS];          /* forward positive */
    double since_us;                    /* instant from which the commands are not yet in the sums */
    double begun_us, sum_us[BOARD_MOTORS];      /* begin of the slice, and the sums over it of command * us */
};

/* It is off below 6 V, or below what its settings say, and while its emergency input is low. */
static inline int sabertooth_is_open(const struct sabertooth_driver *d)
{
    return d->board->cord_pulled || d->board->driver_volts < fmax(6, d->volts_min);
}

static inline void sabertooth_hold(struct sabertooth_driver *d, double until_us)
{
    if (until_us <= d->since_us)
        return;
    for (int k = 0; k < BOARD_MOTORS && !sabertooth_is_open(d); k++) {
        struct motor_model *motor = &d->board->motor[k];
        motor->drive_peak = (int)fmax(motor->drive_peak, ceil(fabs(255.0 * d->command[k] / SABERTOOTH_FULL)));
        d->sum_us[k] += d->command[k] * (until_us - d->since_us);
    }
    d->since_us = until_us;
}

/* Let time pass: the time-out may end within it. */
static inline void sabertooth_pass(struct sabertooth_driver *d, double now_us)
{
    double lost_us = d->heard_us + d->timeout_us;
    if (d->timeout_us && now_us >= lost_us) {
        sabertooth_hold(d, lost_us);
        memset(d->command, 0, sizeof d->command);
    }
    sabertooth_hold(d, now_us);
}

static inline void sabertooth_obey(struct sabertooth_driver *d, int command, int value)
{
    if (command == SABERTOOTH_MIN_VOLTS)
        d->volts_min = 6 + value / 5.0;
    else if (command == SABERTOOTH_TIMEOUT)
        d->timeout_us = 100000.0 * value;
    else if (command < 8 && (command & 3) < 2)  /* 0 and 1: the first motor, forward and back; 4 and 5: the second */
        d->command[command / 4] = command & 1 ? -value : value;
}

static inline void sabertooth_byte(struct sabertooth_driver *d, uint8_t byte, double now_us)
{
    sabertooth_pass(d, now_us);
    if (d->board->driver_line_cut)
        return;
    if (!d->board->driver_wakes) {
        d->board->driver_wakes = byte == SABERTOOTH_SETS_BAUD;
        return;
    }
    if (byte > SABERTOOTH_FULL)         /* only a packet's first byte is so large */
        d->n = 0;
    else if (!d->n)
        return;
    d->packet[d->n++] = byte;
    if (d->n < SABERTOOTH_PACKET)
        return;
    d->n = 0;
    const uint8_t *p = d->packet;
    if (p[0] != SABERTOOTH_ADDRESS || p[3] != ((p[0] + p[1] + p[2]) & SABERTOOTH_FULL))
        return;
    d->heard_us = now_us;
    sabertooth_obey(d, p[1], p[2]);
}

/* A slice begins. The world may have moved its inputs, and taken its power. */
static inline void sabertooth_begin(struct sabertooth_driver *d, double now_us)
{
    if (!d->board->driver_wakes)
        *d = (struct sabertooth_driver){ .board = d->board, .since_us = now_us };
    d->begun_us = now_us;
    memset(d->sum_us, 0, sizeof d->sum_us);
}

static inline void sabertooth_end(struct sabertooth_driver *d, double now_us)
{
    sabertooth_pass(d, now_us);
    d->board->driver_open = sabertooth_is_open(d);
    for (int k = 0; k < BOARD_MOTORS; k++) {
        double command = d->board->driver_open ? 0 : d->command[k];
        if (now_us > d->begun_us)
            command = d->sum_us[k] / (now_us - d->begun_us);
        d->board->motor[k].drive = 255 * command / SABERTOOTH_FULL;
    }
}
#endif
