/* The limit of a board with a potentiometer: it lowers what is asked of both wheels, and raises nothing. */
#ifndef GIRAFF_LIMIT_H
#define GIRAFF_LIMIT_H
#include <stdbool.h>
#include <stdint.h>

void limit_on_millisecond(bool drives);

/* Lower both values alike, so that the curve stays, to the share of `most` that is allowed now; whether they were more.
 * Neither is more than `most`, and that is no more than 10 million. */
bool limit_lower(int32_t values[2], uint32_t most);

#endif
