/* Edges that come too fast to be counted one by one with the time of each: the interrupt gathers them, and each
 * millisecond takes them in. gathered.c implements encoders.h by it, in the place of encoders.c. */
#ifndef GIRAFF_GATHERED_H
#define GIRAFF_GATHERED_H
#include <stdbool.h>
#include <stdint.h>

struct gathered {               /* of an encoder, since the millisecond began */
    uint8_t edges;
    uint8_t forward;            /* of them, by channel B */
    uint8_t at;                 /* the newest: counts of the clock's timer, */
    uint8_t ended;              /* and after them, not 0 = that millisecond has ended and its interrupt waits */
};
extern volatile struct gathered gathered[2];

/* From the interrupt at each edge of channel A, with the channels' levels just after it. The timer and, after it, its
 * flag are read by the caller. It must be short: B changes a quarter of a period after A. */
static inline void gathered_on_edge(uint8_t encoder, bool a, bool b, uint8_t at, uint8_t ended)
{
    volatile struct gathered *g = &gathered[encoder];
    g->at = at;
    g->ended = ended;
    g->edges++;
    if ((a != b) == (encoder == 0))
        g->forward++;
}

#endif
