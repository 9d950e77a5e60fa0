/* Where the counters that wrap start after a reset. A test links other values, to see them wrap in its time. */
#ifndef GIRAFF_START_VALUES_H
#define GIRAFF_START_VALUES_H
#include <stdint.h>

struct start_values {
    uint32_t board_ms;
    uint32_t board_us;
    uint32_t ticks;         /* of each encoder */
    uint16_t seq;           /* of the frames the board sends */
};

extern const struct start_values start_values;

#endif
