/* Whether something holds a wheel that its loop would push the harder. Only policy. */
#ifndef GIRAFF_HELD_H
#define GIRAFF_HELD_H
#include <stdbool.h>
#include <stdint.h>

struct held {               /* of one wheel; all zero while it is to stand */
    int32_t had_um_s;       /* speed that it has had, and is still asked for */
    uint16_t behind_ms;     /* for so long it has had less than half of what it is asked for */
    uint8_t fallen_ms;      /* for so long it has had less than half of what it had */
    bool has_turned;
};

/* Each SPEED_PERIOD_MS. asked_um_s: what the wheel's loop holds now, and um_s: what the wheel does, both positive in
 * the direction that is asked for; 0 = it is to stand. silent_ms: since its newest edge. */
bool held_judge(struct held *h, int32_t asked_um_s, int32_t um_s, uint16_t silent_ms);

#endif
