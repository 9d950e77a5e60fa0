/* A RoboClaw as its maker's manual has it: packets go in, a duty for each motor comes out. For the simulated world, and
 * for drivers of others, which judge it on a pseudo terminal.
 *
 * Times are microseconds and never go back. Zero all of it, then give it power.
 */
#ifndef GIRAFF_ROBOCLAW_MODEL_H
#define GIRAFF_ROBOCLAW_MODEL_H
#include <stdint.h>

enum { ROBOCLAW_MOTORS = 2, ROBOCLAW_FULL = 32767, ROBOCLAW_REPLY_MAX = 64 };

struct roboclaw {
    double volts;                       /* in: of its battery */
    int is_pressed;                     /* in: its emergency input */
    int64_t edges[ROBOCLAW_MOTORS];     /* in: of each encoder so far */
    double duty[ROBOCLAW_MOTORS];       /* out: now, of ROBOCLAW_FULL */
    double duty_us[ROBOCLAW_MOTORS];    /* out: its integral; the caller may set it to 0 */
    double duty_peak[ROBOCLAW_MOTORS];  /* out: the largest size of it; the caller may set it to 0 */
    unsigned packets, damaged;          /* out: obeyed or answered, and not understood */

    /* Its own. */
    double target[ROBOCLAW_MOTORS];
    double rate[ROBOCLAW_MOTORS];       /* of the duty, in a second */
    int64_t counts_from[ROBOCLAW_MOTORS];
    uint8_t timeout_tenths;             /* of a second; 0 = none, as after its power was off */
    double passed_us, heard_us;
    uint8_t packet[32], n;
};

void roboclaw_power_on(struct roboclaw *r, double now_us);
void roboclaw_pass(struct roboclaw *r, double now_us);

/* A byte has come, with edges[] as they are. Write a reply of ROBOCLAW_REPLY_MAX at most; its length, 0 = none. */
int roboclaw_on_byte(struct roboclaw *r, uint8_t byte, double now_us, uint8_t *reply);

#endif
