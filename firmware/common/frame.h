/* Frames on the line: COBS(body + CRC-16 of body, low byte first) + 0x00. */
#ifndef GIRAFF_FRAME_H
#define GIRAFF_FRAME_H
#include <stdint.h>
#include "board.h"
#include "protocol.h"

union any_frame {
    struct hello hello;
    struct wheels wheels;
    struct tilt tilt;
    struct range range;
    struct hello_request hello_request;
    struct configure configure;
    struct drive drive;
    struct speed speed;
    struct estop estop;
    struct tick tick;
#ifdef BOARD_FRAMES
    BOARD_FRAMES
#endif
};

enum {
    FRAME_BODY_MAX = sizeof(union any_frame),
    FRAME_CRC_SIZE = 2,
    FRAME_CODED_MAX = FRAME_BODY_MAX + FRAME_CRC_SIZE + 1,      /* without the 0x00 */
    FRAME_LINE_MAX = FRAME_CODED_MAX + 1
};

/* Encodes n <= FRAME_BODY_MAX bytes for the line: the length at `line`, its 0x00 included. */
uint8_t frame_encode(const void *body, uint8_t n, uint8_t line[FRAME_LINE_MAX]);

struct frame_decoder {
    uint8_t bytes[FRAME_CODED_MAX];     /* of the frame under way; of the body once it is complete */
    uint8_t n;
    uint16_t errors;                    /* frames lost to a wrong CRC or shape; wraps */
};

/* Takes the line's next byte. When it completes a good frame: its body's length, and the body is at bytes until
 * the next call. Otherwise 0. */
uint8_t frame_decode(struct frame_decoder *decoder, uint8_t byte);

#endif
