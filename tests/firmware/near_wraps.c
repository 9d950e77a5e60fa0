#include "start_values.h"

const struct start_values start_values = {
    .board_ms = UINT32_MAX - 999,           /* 0 after a second */
    .board_us = UINT32_MAX - 499999,        /* 0 after half a second */
    .ticks = INT32_MAX - 99,                /* the largest count of the wire, plus 1, after 100 edges */
    .seq = UINT16_MAX - 19,                 /* 0 after 20 frames */
};
