/* The newest moment of the robot's clock that the host has sent down. */
#ifndef GIRAFF_TICK_H
#define GIRAFF_TICK_H
#include <stdint.h>

struct held_tick {
    uint32_t epoch;         /* 0 = none yet */
    uint64_t robot_ns;
};

void tick_on_frame(const void *body);
struct held_tick tick_newest(void);

#endif
