/* What the robot is to do now: its speed, place and turn, and the lean at which it stands. */
#ifndef GIRAFF_REFERENCE_H
#define GIRAFF_REFERENCE_H
#include "control.h"
#include "kalman.h"
#include "wheel_speed.h"

#define LEASH 0.05f                     /* m. Beyond it the held place follows the robot: pushed away it stays away. */

struct reference {
    float speed, acceleration;          /* m/s, m/s2 */
    float ahead;                        /* m by which the axle is before the held place */
    float turn;                         /* rad/s */
    float turn_behind;                  /* rad by which it has turned less to the left than it is to */
    bool halts;                         /* the order of the last period */
    bool is_held;                       /* an obstacle holds it */
    bool sways;                         /* it stands, and turns to and fro to see its encoders count */
    uint16_t sways_for;                 /* periods, to this side */
    uint16_t slow, astray;              /* periods */
    float trim;                         /* rad: lean at which it stands */
    float usual;                        /* rad: the trim of the last half minute */
    float unexplained;                  /* rad by which the trim seems to be wrong */
    float momentum;                     /* about the wheels' contact, as the lean that gives it in a period: rad */
};

struct reference_input {
    const struct model *model;
    const struct balance_order *order;
    const struct kalman *kalman;
    const struct wheel_speed *wheels;
    bool stands;
    uint16_t since;                     /* periods in which it has stood */
    bool is_second;                     /* of two periods */
};

/* It stands up, here. */
void reference_start(struct reference *r);
/* It holds its place, from here on. */
void reference_halt(struct reference *r);
void reference_step(struct reference *r, const struct reference_input *in);

#endif
