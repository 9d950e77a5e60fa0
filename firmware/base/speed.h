/* The wheels' speed control: each wheel's PI loop about its feed-forward, coupled by the PI loop of their turn.
 * Only policy, in integers: what is asked, edges, their times and volts come in as arguments, PWM goes out, the same on
 * every machine. Wheels are LEFT and RIGHT of wiring.h. */
#ifndef GIRAFF_SPEED_H
#define GIRAFF_SPEED_H
#include <stdbool.h>
#include <stdint.h>
#include "held.h"
#include "protocol.h"
#include "speedometer.h"

enum { WHEELS = 2 };

struct speed_settings {             /* of a session */
    uint32_t um_per_tick_q8[WHEELS];    /* 0 = not known: no speeds */
    int32_t step_um_s;              /* most that a speed grows in a period */
    uint32_t forward_q23;           /* PWM counts for each um/s at the nominal voltage */
    int32_t forward_max_um_s;       /* a larger speed counts as this, and nothing overflows */
    uint16_t nominal_adc_counts;
    uint16_t motor_periods_q8;      /* time constant of a motor */
    uint8_t pwm_max, stall_pwm, dead_pwm;
    struct gains {
        uint16_t p_q24;             /* PWM counts for each um/s that is missing, */
        uint16_t i_q24;             /* and what each adds to the integral in a period */
        int32_t error_max;          /* um/s: a larger one counts as this, and nothing overflows */
    } wheel, turn;
};

struct speed_input {
    int32_t asked_um_s[WHEELS];     /* forward positive */
    uint16_t ticks[WHEELS];         /* low halves of the counts, */
    uint16_t stamps[WHEELS];        /* when the newest edge of each came, */
    uint16_t now;                   /* and the time, all in STAMPS_PER_MS */
    uint16_t battery_adc_counts;
};

struct speed_control {              /* all zero at first */
    struct speed_wheel {
        struct speedometer speedometer;
        struct held held;
        int32_t ramp_um_s;          /* what is asked, on its way up, */
        int32_t set_um_s;           /* and the same smoothed: what the loop holds */
        uint16_t growth_um_s;       /* of its magnitude in the last period; stays at the largest */
        int32_t due_um_s;           /* what the speedometer would show of a wheel that does what is set, which it does late */
        int32_t integral_q16;       /* PWM counts in the direction that is set */
        int32_t pwm_q8;             /* what the wheel is to get, of 255 * 256, forward positive */
    } wheel[WHEELS];
    int32_t turn_q16;               /* integral of the turn loop: to the right wheel, from the left one */
    uint16_t battery_q4;            /* ADC counts, smoothed; 0 = none yet */
    uint16_t lost_q15;              /* share of what is set that the wheels are not asked for, since one cannot */
    uint8_t short_for;              /* periods in which a wheel has had all that it may get and was too slow */
    uint8_t flags;                  /* enum speed_flag */
    uint16_t against;               /* speed of both wheels against what was asked in the last period, 512 um/s */
    uint16_t least_against;         /* the least of it since they turn against, */
    uint8_t no_slower_for;          /* and periods since then; stays at PULLED_FOR */
};

/* Whether a session can have them; then they are at *settings. */
bool speed_configure(struct speed_settings *settings, const struct configure *asked);

/* Each SPEED_PERIOD_MS, also of wheels that nothing is asked of. True: a wheel is held, as flags say; stop. */
bool speed_step(struct speed_control *s, const struct speed_settings *settings, const struct speed_input *in);

/* Each millisecond: a stop does not wait for the period; another direction, and going on after a stop, begin from
 * rest. */
void speed_on_asked(struct speed_control *s, uint8_t wheel, int32_t um_s);

/* Nothing is left of what the loops have gathered. */
void speed_stop(struct speed_control *s);

/* Edges so far tell nothing of those to come: other encoders, or counted the other way. */
void speed_forget_wheels(struct speed_control *s);

#endif
