/* Both channels of two encoders, each edge of which counts. Forward is A before B. */
#ifndef GIRAFF_ENCODERS_H
#define GIRAFF_ENCODERS_H
#include <stdint.h>

void encoders_start(void);
void encoders_take(int16_t moved[2]);           /* counts since the last call */

void encoders_on_change(uint8_t pins);          /* from the pins' interrupt; as hal_encoder_pins has them */

#endif
