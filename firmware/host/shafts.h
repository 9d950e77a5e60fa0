/* Encoders on the motors' shafts: both channels, edge by edge, as the motors' positions have it. */
#ifndef GIRAFF_SHAFTS_H
#define GIRAFF_SHAFTS_H
#include <stdint.h>

void shafts_open(void (*to)(int k, int a, int b));      /* whom it tells the levels of encoder k */
void shafts_begin(uint64_t until_ns);           /* of a slice */
void shafts_on_event(int k);                    /* PART_0 and PART_1 are theirs */

#endif
