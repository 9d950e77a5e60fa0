#include "protocol.h"
#include "tick.h"

static struct held_tick newest;

void tick_on_frame(const void *body)
{
    const struct tick *tick = body;
    newest = (struct held_tick){ .epoch = tick->epoch, .robot_ns = tick->robot_ns };
}

struct held_tick tick_newest(void)
{
    return newest;
}
