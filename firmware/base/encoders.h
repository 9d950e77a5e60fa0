/* The encoders' counts: both edges of channel A, forward positive, as the hardware facts have the signs. */
#ifndef GIRAFF_ENCODERS_H
#define GIRAFF_ENCODERS_H
#include <stdbool.h>
#include <stdint.h>

struct encoders_reading {       /* of one instant */
    uint32_t at_us;
    uint32_t counts[2];
};

void encoders_start(void);
struct encoders_reading encoders_read(void);
uint16_t encoders_low(uint8_t encoder);         /* the low half of its count: enough for what turns in a second */

/* From the interrupt at each edge of the encoder's channel A, with the channels' levels just after it. */
void encoders_on_edge_0(bool a, bool b);
void encoders_on_edge_1(bool a, bool b);

#endif
