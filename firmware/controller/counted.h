/* Encoders that a motor controller counts, and tells now and then. counted.c implements encoders.h by it, in the place of
 * encoders.c. */
#ifndef GIRAFF_COUNTED_H
#define GIRAFF_COUNTED_H
#include <stdint.h>

/* What its counters say now. They wrap, and begin anywhere. */
void counted_on_reading(const uint32_t counters[2]);

#endif
