/* What a base board drives its motors with: bridges.c by PWM, servos.c by pulses. base_parts.c has the rest. */
#ifndef GIRAFF_OUTPUTS_H
#define GIRAFF_OUTPUTS_H

void outputs_open(void);
void outputs_reset(void);       /* the pins are inputs again */
void outputs_begin(void);       /* of a slice */
void outputs_end(void);
void outputs_on_event(int part);

#endif
