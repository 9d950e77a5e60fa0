/* Two seconds before the clocks wrap, a little before ticks and sequence numbers do. */
#include "start_values.h"

const struct start_values start_values = {
    .board_ms = 0xFFFFFFFF - 2000,
    .board_us = 0xFFFFFFFF - 2000000,
    .ticks = 0x7FFFFFFF - 500,
    .seq = 0xFFFF - 20,
};
