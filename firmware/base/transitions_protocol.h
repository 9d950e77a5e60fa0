/* What the base board says of each change on an encoder's two channels. A header beside protocol.h, so that the hash of
 * that one stays as it is. `generate_codec.py` makes schemas/giraff_schemas/wires/transitions.py from it.
 *
 * The board says nothing of them before a request. A request holds for TRANSITIONS_HOLD_MS, and another one prolongs it.
 * Until then the board sends a frame when TRANSITIONS_MAX are there and each TRANSITIONS_PERIOD_MS, also an empty one.
 */
#ifndef GIRAFF_TRANSITIONS_PROTOCOL_H
#define GIRAFF_TRANSITIONS_PROTOCOL_H
#include "protocol.h"

enum transitions_frame_type {
    FRAME_TRANSITIONS = 0x07,           /* board to host */
    FRAME_TRANSITIONS_REQUEST = 0x1b    /* host to board */
};

enum {
    TRANSITIONS_MAX = 24,               /* in a frame */
    TRANSITIONS_PERIOD_MS = 50,
    TRANSITIONS_HOLD_MS = 500,
    TRANSITIONS_OF_NONE = 0xff,         /* as the encoder of a request: ends it */
    TRANSITION_A = 0x8000,              /* channel A is high just after the transition */
    TRANSITION_B = 0x4000,
    TRANSITION_STAMPS = 0x3fff          /* the other bits: stamps of STAMPS_PER_MS since the transition before it. All
                                         * of them set: longer, or unknown, since it is the first or others were lost
                                         * before it */
};

struct PACKED transitions {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;                  /* when the frame was made */
    uint32_t boot_id;
    uint8_t encoder;                    /* 0 or 1, as the pins are numbered: no wiring swaps or inverts it */
    uint8_t count;                      /* so many of `transitions`, oldest first; the rest are 0 */
    uint16_t transitions[TRANSITIONS_MAX];
};

struct PACKED transitions_request {
    uint8_t type;
    uint16_t seq;
    uint8_t encoder;                    /* any other than 0, 1 and TRANSITIONS_OF_NONE is ignored */
};

#endif
