/* The encoders' counts: both edges of channel A, forward positive, as the hardware facts have the signs. */
#ifndef GIRAFF_ENCODERS_H
#define GIRAFF_ENCODERS_H
#include <stdbool.h>
#include <stdint.h>

struct encoders_reading {       /* of one instant, which may be the last millisecond's */
    uint32_t at_us;
    uint32_t counts[2];
};

void encoders_start(void);
struct encoders_reading encoders_read(void);

struct encoders_edge {          /* the newest of an encoder */
    uint16_t ticks;             /* low half of the count after it: enough for what turns in a second */
    uint16_t stamp;             /* clock_stamp() when it came */
};

struct encoders_edge encoders_newest(uint8_t encoder);

/* clock_stamp() of the moment up to which each edge is known: now, where edges come by interrupts. Interrupts off. */
uint16_t encoders_until(void);

/* From the interrupt at each edge of the encoder's channel A, with the channels' levels just after it. */
void encoders_on_edge_0(bool a, bool b);
void encoders_on_edge_1(bool a, bool b);

/* From the millisecond interrupt, as its first: with interrupts off, which it may enable. */
void encoders_on_millisecond(void);

#endif
