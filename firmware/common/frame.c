#include <string.h>
#include "cobs.h"
#include "crc.h"
#include "frame.h"

_Static_assert(FRAME_BODY_MAX + FRAME_CRC_SIZE <= COBS_MAX, "a frame must fit one COBS block");

enum { OVERLONG = FRAME_CODED_MAX + 1 };

uint8_t frame_encode(const void *body, uint8_t n, uint8_t line[FRAME_LINE_MAX])
{
    uint8_t plain[FRAME_BODY_MAX + FRAME_CRC_SIZE];
    memcpy(plain, body, n);
    uint16_t crc = crc16(plain, n);
    plain[n++] = (uint8_t)crc;
    plain[n++] = (uint8_t)(crc >> 8);
    cobs_encode(plain, n++, line);
    line[n++] = 0;
    return n;
}

static uint8_t body_length(uint8_t *coded, uint8_t n)
{
    n = cobs_decode(coded, n);
    if (n <= FRAME_CRC_SIZE)
        return 0;
    n = (uint8_t)(n - FRAME_CRC_SIZE);
    uint16_t crc = (uint16_t)(coded[n] | (uint16_t)((uint16_t)coded[n + 1] << 8));
    return crc16(coded, n) == crc ? n : 0;
}

uint8_t frame_decode(struct frame_decoder *decoder, uint8_t byte)
{
    uint8_t n = decoder->n;
    if (byte) {
        if (n < FRAME_CODED_MAX)
            decoder->bytes[n] = byte;
        if (n < OVERLONG)
            decoder->n++;
        return 0;
    }
    decoder->n = 0;
    if (!n)
        return 0;       /* an idle line: two zeros follow each other */
    uint8_t body = n < OVERLONG ? body_length(decoder->bytes, n) : 0;
    if (!body)
        decoder->errors++;
    return body;
}
