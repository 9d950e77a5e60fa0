#include "crc.h"

/* Eight steps of the polynomial 0x1021 at once: no table, and no loop over bits. */
static uint16_t crc16_add(uint16_t crc, uint8_t byte)
{
    uint8_t x = (uint8_t)(crc >> 8) ^ byte;
    x ^= x >> 4;
    return (uint16_t)((uint16_t)(crc << 8) ^ (uint16_t)((uint16_t)x << 12) ^ (uint16_t)((uint16_t)x << 5) ^ x);
}

uint16_t crc16(const uint8_t *bytes, uint8_t n)
{
    uint16_t crc = 0xffff;
    while (n--)
        crc = crc16_add(crc, *bytes++);
    return crc;
}
