/* Consistent overhead byte stuffing: bytes without any 0x00, so that 0x00 ends a frame and nothing else. */
#ifndef GIRAFF_COBS_H
#define GIRAFF_COBS_H
#include <stdint.h>

enum { COBS_MAX = 253 };    /* of cobs_encode's n: longer input would need a second code byte */

/* Encodes n bytes into n + 1 at `to`, which must not overlap them. */
void cobs_encode(const uint8_t *from, uint8_t n, uint8_t *to);

/* Decodes n bytes, none of them 0x00, in place: the length, 0 when no encoder wrote this. */
uint8_t cobs_decode(uint8_t *bytes, uint8_t n);

#endif
