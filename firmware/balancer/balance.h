/* How the robot balances: from readings and what is asked of it to commands for the motors, once each control period.
 * Only computation: no pins, no clock, no wire. SI units. Forward, leaning forward and turning left are positive. In
 * pairs the left wheel comes first.
 */
#ifndef GIRAFF_BALANCE_H
#define GIRAFF_BALANCE_H
#include <stdbool.h>
#include <stdint.h>
#include "balancer_protocol.h"

/* Of the session: balance_configure in SI units. */
struct balance_settings {
    float k1, k2, k3, k4;               /* N m per rad, rad/s, m, m/s */
    float gravity;                      /* N m per rad: m g l */
    float momentum_per_speed;           /* kg m */
    float momentum_per_rate;            /* kg m2 */
    float radius, track;                /* m */
    float rad_per_count;                /* of a wheel */
    float motor_constant, motor_ohm;    /* V s/rad at the wheel */
    float friction;                     /* N m of one motor */
    float torque_max;                   /* N m */
    float acceleration, braking;        /* m/s2 */
    float speed_max, turn_max;          /* m/s, rad/s */
    float volts_min;                    /* V */
};

struct balance_readings {
    float gyro[2];                      /* ADC counts, means of a period: both axes, at 45 degrees to the axle */
    float forward, up;                  /* ADC counts: the accelerometer */
    int32_t counts[2];                  /* encoders, the motor against the chassis, forward positive */
    float volts;                        /* V of the battery */
    bool cord_pulled;
};

struct balance_order {
    float linear, angular;              /* m/s, rad/s, within the settings */
    bool halts;                         /* stop at once and hold the place: no command, time-out, emergency stop */
    bool may_stand;                     /* it is asked to stand up */
    bool sits;                          /* it is asked to sit down */
    bool off;                           /* the motors are to have no power, */
    uint8_t off_cause;                  /* and why: enum balance_cause */
    uint8_t free_side;                  /* enum balance_side */
};

struct balance_state {                  /* what the report tells */
    uint8_t posture, cause, flags;      /* of balancer_protocol.h, without BALANCE_CORD */
    float lean, rate, accelerometer;    /* rad, rad/s, rad */
    float trim;                         /* rad */
    float speed, turn;                  /* m/s, rad/s */
    float torque;                       /* N m */
    int8_t command[2];                  /* to the motor driver, forward positive; 0, 0 while it is off */
};

void balance_start(void);                                       /* after a reset: off */
void balance_configure(const struct balance_settings *settings);       /* it halts, and stands on if it stood */
void balance_step(const struct balance_readings *readings, const struct balance_order *order);
const struct balance_state *balance_state(void);

#endif
