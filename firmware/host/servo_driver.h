/* A motor driver in R/C mode, as the simulated world has it: two copies of it for both simulators of a board. Servo
 * pulses go in, a duty comes out. Neutral brakes. The last pulse counts until the time-out, as a Sabertooth has it.
 *
 * The board's side calls servo_driver_pin at each edge of its pin, and begin and end around each slice. Times are
 * simulated microseconds and never go back.
 */
#ifndef GIRAFF_SERVO_DRIVER_H
#define GIRAFF_SERVO_DRIVER_H
#include <math.h>
#include "board_model.h"

/* The dead band is an estimate, to each side of neutral; the maker publishes none. */
enum { SERVO_NEUTRAL_US = 1500, SERVO_SPAN_US = 500, SERVO_DEAD_US = 10, SERVO_TIMEOUT_MS = 100 };

struct servo_driver {
    struct board_model *board;
    int number;                 /* of board->motor */
    int pin, line;              /* levels of the board's pin, and at the driver: low where the wire is off */
    double pin_rose_us, line_rose_us;
    double heard_us;            /* end of the newest pulse at the driver */
    double duty;                /* now, signed */
    double since_us;            /* instant from which `duty` is not yet in the sum */
    double begun_us, duty_us;   /* begin of the slice, and the sum over it of duty * us */
};

static inline double servo_driver_duty(double pulse_us)
{
    double beyond = pulse_us - SERVO_NEUTRAL_US;
    return fabs(beyond) < SERVO_DEAD_US ? 0 : fmin(fmax(255 * beyond / SERVO_SPAN_US, -255), 255);
}

static inline void servo_driver_hold(struct servo_driver *d, double until_us)
{
    struct motor_model *motor = &d->board->motor[d->number];
    if (until_us <= d->since_us)
        return;
    motor->drive_peak = (int)fmax(motor->drive_peak, ceil(fabs(d->duty)));
    d->duty_us += d->duty * (until_us - d->since_us);
    d->since_us = until_us;
}

/* Let time pass: the time-out may end within it. */
static inline void servo_driver_pass(struct servo_driver *d, double now_us)
{
    double lost_us = d->heard_us + 1000.0 * d->board->driver_timeout_ms;
    if (d->board->driver_timeout_ms && now_us >= lost_us) {
        servo_driver_hold(d, lost_us);
        d->duty = 0;
    }
    servo_driver_hold(d, now_us);
}

static inline void servo_driver_pin(struct servo_driver *d, int level, double now_us)
{
    struct motor_model *motor = &d->board->motor[d->number];
    int line = level && !motor->signal_cut;
    servo_driver_pass(d, now_us);
    if (level && !d->pin)
        d->pin_rose_us = now_us;
    else if (!level && d->pin)
        motor->pulse_us = now_us - d->pin_rose_us;
    if (line && !d->line) {
        d->line_rose_us = now_us;
    } else if (!line && d->line) {
        d->heard_us = now_us;
        d->duty = servo_driver_duty(now_us - d->line_rose_us);
    }
    d->pin = level;
    d->line = line;
}

/* A slice begins. The world may have cut or mended the wire, in the midst of a pulse, too: the driver then sees the
 * piece of it, as it does when a reset of the board cuts one short. */
static inline void servo_driver_begin(struct servo_driver *d, double now_us)
{
    servo_driver_pin(d, d->pin, now_us);
    d->begun_us = now_us;
    d->duty_us = 0;
}

/* The board's program stands, and its timer gives the newest pulse again and again. */
static inline void servo_driver_repeat(struct servo_driver *d, double now_us)
{
    const struct motor_model *motor = &d->board->motor[d->number];
    servo_driver_pass(d, now_us);
    d->pin = d->line = 0;
    if (motor->signal_cut || motor->pulse_us == 0)
        return;
    d->heard_us = now_us;
    d->duty = servo_driver_duty(motor->pulse_us);
}

static inline void servo_driver_end(struct servo_driver *d, double now_us)
{
    servo_driver_pass(d, now_us);
    d->board->motor[d->number].drive = now_us > d->begun_us ? d->duty_us / (now_us - d->begun_us) : d->duty;
}
#endif
