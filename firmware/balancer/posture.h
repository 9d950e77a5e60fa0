/* Whether it is off, stands or sits down, and why. Only policy. */
#ifndef GIRAFF_POSTURE_H
#define GIRAFF_POSTURE_H
#include "control.h"
#include "kalman.h"
#include "watch.h"

struct posture {
    uint8_t posture;                    /* enum balance_posture */
    uint8_t cause;                      /* enum balance_cause */
    uint8_t side;                       /* enum balance_side, to which it sits down */
    bool leans_over;                    /* it has stopped, and lets itself down to that side */
    bool is_calm;                       /* upright and still for long enough */
    uint16_t still;                     /* periods */
    uint16_t since;                     /* periods in this posture, or since it began to lean over */
};

struct posture_input {
    const struct balance_order *order;
    const struct kalman *kalman;
    bool cord_pulled;
    uint16_t faults;                    /* of watch.h */
    float speed;                        /* m/s of the axle */
    float trim;                         /* rad: lean at which it stands */
};

/* true if it has just stood up. */
bool posture_step(struct posture *p, const struct posture_input *in);

#endif
