#ifndef GIRAFF_CRC_H
#define GIRAFF_CRC_H
#include <stdint.h>

/* CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xffff; check value 0x29b1. */
uint16_t crc16(const uint8_t *bytes, uint8_t n);

#endif
