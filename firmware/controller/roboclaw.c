/* RoboClaw, packet serial: address, command, data, and a CRC of all of it. It answers with 0xff, or with data and a CRC
 * of address, command and data. Numbers are big-endian. Source: Basicmicro's "RoboClaw User Manual", "Packet Serial". */
#include "boards.h"
#include "controller.h"

enum { ADDRESS = 0x80, ACKNOWLEDGED = 0xff };
enum {
    SET_TIMEOUT = 14,
    GET_TIMEOUT = 15,
    VERSION = 21,
    SET_COUNTER_1 = 22,
    SET_COUNTER_2 = 23,
    BATTERY = 24,
    DUTY = 54,                          /* with an acceleration; 34 would take one that is stored in the controller */
    COUNTERS = 78,
    STATUS = 90
};
static const uint8_t PROOFS[] = { DUTY, VERSION, SET_TIMEOUT, GET_TIMEOUT, SET_COUNTER_1, SET_COUNTER_2, COUNTERS };
static const uint8_t OTHERS[] = { STATUS, GET_TIMEOUT, STATUS, BATTERY };

static const uint32_t FASTEST = 655359;         /* acceleration: from full to none in 50 ms */
static const uint32_t BEGINS = 1ul << 30;       /* counters: none counts from there after its power was off */
static const uint8_t TIMEOUT_TENTHS = ROBOCLAW_STOPS_AFTER_MS / 100;       /* of a second */
static const uint32_t STOP_IS_PRESSED = 1;

static uint8_t command;                         /* of the newest request */
static uint16_t sum;                            /* its CRC, which goes on in its reply */
static uint8_t got[48], n, needs;               /* the reply so far, and its bytes; 0 = a text up to a zero, then its CRC */

static uint16_t crc_with(uint16_t crc, uint8_t byte)
{
    crc ^= (uint16_t)(byte << 8);
    for (uint8_t bit = 0; bit < 8; bit++)
        crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    return crc;
}

static uint8_t *put(uint8_t *to, uint32_t value, uint8_t bytes)
{
    while (bytes--)
        *to++ = (uint8_t)(value >> 8 * bytes);
    return to;
}

static uint32_t number_at(const uint8_t *from, uint8_t bytes)
{
    uint32_t value = 0;
    while (bytes--)
        value = value << 8 | *from++;
    return value;
}

/* With its CRC. */
static uint8_t reply_bytes(void)
{
    switch (command) {
    case VERSION:
        return 0;
    case GET_TIMEOUT:
        return 3;
    case BATTERY:
        return 4;
    case STATUS:
        return 6;
    case COUNTERS:
        return 10;
    default:
        return 1;
    }
}

static uint8_t ask(uint8_t *to, enum step step, uint8_t number, const int16_t duty[CONTROLLER_MOTORS])
{
    command = step == STEP_PROVE ? PROOFS[number] : step == STEP_OTHER ? OTHERS[number]
              : step == STEP_COMMAND ? DUTY : COUNTERS;
    uint8_t *end = put(put(to, ADDRESS, 1), command, 1);
    for (uint8_t motor = 0; command == DUTY && motor < CONTROLLER_MOTORS; motor++)
        end = put(put(end, (uint16_t)duty[motor], 2), FASTEST, 4);
    if (command == SET_TIMEOUT)
        end = put(end, TIMEOUT_TENTHS, 1);
    if (command == SET_COUNTER_1 || command == SET_COUNTER_2)
        end = put(end, BEGINS, 4);
    sum = 0;
    for (const uint8_t *byte = to; byte < end; byte++)
        sum = crc_with(sum, *byte);
    n = 0;
    needs = reply_bytes();
    if (needs == 1)                     /* only what sets something has a CRC of its own */
        end = put(end, sum, 2);
    return (uint8_t)(end - to);
}

/* Older ones have other sums and another status. */
static bool is_version_4(void)
{
    for (uint8_t i = 0; i + 2 < n; i++)
        if (got[i] == 'v' && got[i + 1] == '4' && got[i + 2] == '.')
            return true;
    return false;
}

static enum heard take(void)
{
    switch (command) {
    case VERSION:
        return is_version_4() ? HEARD_ALL : HEARD_OTHERWISE;
    case GET_TIMEOUT:
        return got[0] == TIMEOUT_TENTHS ? HEARD_KEPT : HEARD_OTHERWISE;
    case BATTERY:
        controller_tell_battery((uint16_t)number_at(got, 2));
        break;
    case STATUS:
        if (number_at(got, 4) & STOP_IS_PRESSED)
            controller_tell_stop();
        break;
    case COUNTERS:
        controller_tell_counters((const uint32_t[CONTROLLER_MOTORS]){ number_at(got, 4), number_at(got + 4, 4) });
    }
    return HEARD_ALL;
}

static enum heard hear(uint8_t byte)
{
    if (needs == 1)
        return byte == ACKNOWLEDGED ? HEARD_ALL : HEARD_NOISE;
    got[n++] = byte;
    if (!needs && !byte)
        needs = (uint8_t)(n + 2);
    if (!needs || n < needs)
        return n < sizeof got ? HEARD_PART : HEARD_NOISE;
    for (uint8_t i = 0; i < n - 2; i++)
        sum = crc_with(sum, got[i]);
    return sum == number_at(got + n - 2, 2) ? take() : HEARD_NOISE;
}

const struct protocol protocol = {
    .baud = 115200,
    .expects = "a RoboClaw with firmware 4, in packet serial at address 128 and 115200 baud",
    .cycle_ms = 5,
    .other_ms = 15,
    .reply_ms = 12,
    .quiet_ms = 15,
    .lost_ms = 150,
    .kept_ms = 200,
    .leap = 1ul << 20,
    .proofs = sizeof PROOFS,
    .others = sizeof OTHERS,
    .ask = ask,
    .hear = hear,
    .stop_bytes = 16,
    .stop = { ADDRESS, DUTY, 0, 0, 0, 0x09, 0xff, 0xff, 0, 0, 0, 0x09, 0xff, 0xff, 0x93, 0xb5 },
};
