/* What the ranger board says of its bumpers. A header beside protocol.h, so that the hash of that one stays as it is
 * and no board has to be flashed for it. `generate_codec.py` makes schemas/giraff_schemas/wires/bumper.py from it.
 *
 * The board says nothing of them before the first request since its reset: a host that knows no bumpers reads what
 * it always did. It then sends a frame whenever a switch changes, and every BUMPER_PERIOD_MS.
 */
#ifndef GIRAFF_BUMPER_PROTOCOL_H
#define GIRAFF_BUMPER_PROTOCOL_H
#include "protocol.h"

enum bumper_frame_type {
    FRAME_BUMPER = 0x05,            /* board to host */
    FRAME_BUMPER_REQUEST = 0x17     /* host to board */
};

enum {
    BUMPERS = 2,
    BUMPER_PERIOD_MS = 50,
    BUMPER_REST_MS = 20             /* a switch is closed again when it has been closed for so long */
};

struct PACKED bumper {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;              /* when the switches were read */
    uint32_t boot_id;
    uint32_t tick_epoch;            /* newest tick held then; epoch 0 = none yet */
    uint64_t tick_robot_ns;
    uint8_t open;                   /* bit k: switch k is open, because it is pushed or its wire is off */
};

struct PACKED bumper_request {
    uint8_t type;
    uint16_t seq;
};

#endif
