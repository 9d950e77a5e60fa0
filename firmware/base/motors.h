/* The motors' outputs: what they get, changed in an order that is kind to the bridges. */
#ifndef GIRAFF_MOTORS_H
#define GIRAFF_MOTORS_H
#include <stdint.h>

void motors_start(void);
int16_t motors_level(uint8_t motor);                    /* what it gets now, PWM counts, forward positive */

/* From the millisecond interrupt, each millisecond, which alone writes the motors' registers. */
void motors_on_millisecond(uint8_t motor, int16_t wanted);

#endif
