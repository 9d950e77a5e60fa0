/* A motor controller as its maker describes it: bytes go in, a duty for each motor and replies come out. For the simulated
 * world, and for drivers of others, which judge it on a pseudo terminal. A file for each protocol implements it, once.
 *
 * Times are microseconds and never go back. Zero all of it, then give it power.
 */
#ifndef GIRAFF_CONTROLLER_MODEL_H
#define GIRAFF_CONTROLLER_MODEL_H
#include <stdint.h>

enum { MODEL_MOTORS = 2, MODEL_FULL = 32767, MODEL_REPLY_MAX = 64 };

extern const unsigned model_baud;

struct controller_model {
    double volts;                       /* in: of its battery */
    int is_pressed;                     /* in: its emergency input, where it has one */
    int64_t edges[MODEL_MOTORS];        /* in: of each encoder so far, of both channels */
    double duty[MODEL_MOTORS];          /* out: now, of MODEL_FULL */
    double duty_us[MODEL_MOTORS];       /* out: its integral; the caller may set it to 0 */
    double duty_peak[MODEL_MOTORS];     /* out: the largest size of it; the caller may set it to 0 */
    unsigned packets, damaged;          /* out: obeyed or answered, and not understood */
    double passed_us;                   /* out: until then */
};

void model_power_on(struct controller_model *m, double now_us);
void model_pass(struct controller_model *m, double now_us);

/* A byte has come, with edges[] as they are. Write a reply of MODEL_REPLY_MAX at most; its length, 0 = none. */
int model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply);

/* For the files that implement it: the duty was what it is since passed_us. */
void model_hold(struct controller_model *m, double until_us);

#endif
