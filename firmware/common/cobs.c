#include "cobs.h"

void cobs_encode(const uint8_t *from, uint8_t n, uint8_t *to)
{
    uint8_t *code = to++;       /* says how far it is to the next zero */
    *code = 1;
    while (n--) {
        if (*from) {
            *to++ = *from;
            ++*code;
        } else {
            code = to++;
            *code = 1;
        }
        from++;
    }
}

uint8_t cobs_decode(uint8_t *bytes, uint8_t n)
{
    uint8_t read = 0, written = 0;
    while (read < n) {
        uint8_t code = bytes[read++];
        uint8_t run = (uint8_t)(code - 1);
        if (run > (uint8_t)(n - read))
            return 0;
        while (run--)
            bytes[written++] = bytes[read++];
        if (read < n)
            bytes[written++] = 0;
    }
    return written;
}
