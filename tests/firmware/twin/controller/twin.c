/* TW-2: a mark, the payload's length, the payload, and a byte that makes the sum of all but the mark 0. An answer's payload
 * begins as its request's did. Numbers are little-endian. Source: "TW-2 dual motor controller: serial protocol". */
#include "boards.h"
#include "controller.h"

enum { REQUEST = 0xa5, ANSWER = 0x5a, OUTPUT_FULL = 1000 };
enum { DUTY = 'D', VERSION = 'V', WATCHDOG = 'W', SET_COUNTERS = 'P', COUNTERS = 'C', BATTERY = 'B', INPUTS = 'E' };
enum { SET = 0x80 };                            /* with a letter: what it reads is set */
static const uint8_t PROOFS[] = { DUTY, VERSION, SET | WATCHDOG, WATCHDOG, SET_COUNTERS, COUNTERS };
static const uint8_t OTHERS[] = { INPUTS, WATCHDOG, INPUTS, BATTERY };

static const uint32_t BEGINS = 1ul << 30;       /* counters: none counts from there after its power was off */
static const uint8_t WATCHDOG_HUNDREDTHS = TWIN_STOPS_AFTER_MS / 10;        /* of a second */
static const uint8_t STOP_IS_OPEN = 1;
static const char MODEL[] = { 'T', 'W', '2', '-', '1', '.' };

static uint8_t letter;                          /* of the newest request */
static uint8_t got[48], n;                      /* the answer so far */

static uint8_t *put(uint8_t *to, uint32_t value, uint8_t bytes)
{
    for (; bytes--; value >>= 8)
        *to++ = (uint8_t)value;
    return to;
}

static uint32_t number_at(const uint8_t *from, uint8_t bytes)
{
    uint32_t value = 0;
    while (bytes--)
        value = value << 8 | from[bytes];
    return value;
}

static uint8_t ask(uint8_t *to, enum step step, uint8_t number, const int16_t duty[CONTROLLER_MOTORS])
{
    uint8_t what = step == STEP_PROVE ? PROOFS[number] : step == STEP_OTHER ? OTHERS[number]
                   : step == STEP_COMMAND ? DUTY : COUNTERS;
    letter = what & 0x7f;
    n = 0;
    uint8_t *end = put(to + 2, letter, 1), sum = 0;
    for (uint8_t motor = 0; motor < CONTROLLER_MOTORS; motor++)
        if (letter == DUTY)                     /* towards 0: never more than is asked, nor beyond what it takes */
            end = put(end, (uint32_t)((int32_t)duty[motor] * OUTPUT_FULL / CONTROLLER_FULL), 2);
        else if (letter == SET_COUNTERS)
            end = put(end, BEGINS, 4);
    if (what == (SET | WATCHDOG))
        end = put(end, WATCHDOG_HUNDREDTHS, 1);
    to[0] = REQUEST;
    to[1] = (uint8_t)(end - to - 2);
    for (const uint8_t *byte = to + 1; byte < end; byte++)
        sum = (uint8_t)(sum + *byte);
    return (uint8_t)(put(end, 0u - sum, 1) - to);
}

/* An answer with the right sum. */
static enum heard take(const uint8_t *data, uint8_t bytes)
{
    uint8_t needs = letter == COUNTERS ? 8 : letter == BATTERY ? 2 : letter == WATCHDOG || letter == INPUTS ? 1 : 0;
    if (letter != VERSION && bytes != needs)
        return HEARD_NOISE;
    if (letter == WATCHDOG)
        return data[0] == WATCHDOG_HUNDREDTHS ? HEARD_KEPT : HEARD_OTHERWISE;
    for (uint8_t i = 0; letter == VERSION && i < sizeof MODEL; i++)
        if (i >= bytes || data[i] != MODEL[i])
            return HEARD_OTHERWISE;
    if (letter == BATTERY)
        controller_tell_battery((uint16_t)(number_at(data, 2) / 10));
    if (letter == INPUTS && (data[0] & STOP_IS_OPEN))
        controller_tell_stop();
    if (letter == COUNTERS)
        controller_tell_counters((const uint32_t[CONTROLLER_MOTORS]){ number_at(data, 4), number_at(data + 4, 4) });
    return HEARD_ALL;
}

static enum heard hear(uint8_t byte)
{
    uint8_t sum = 0;
    got[n++] = byte;
    if (got[0] != ANSWER || (n > 1 && (!got[1] || got[1] > sizeof got - 3)) || (n > 2 && got[2] != letter))
        return HEARD_NOISE;
    if (n < 3 || n < got[1] + 3)
        return HEARD_PART;
    for (uint8_t i = 1; i < n; i++)
        sum = (uint8_t)(sum + got[i]);
    return sum ? HEARD_NOISE : take(got + 3, (uint8_t)(got[1] - 1));
}

/* Its stop ends any other request that it may come in the middle of: 11 bytes of no frame end the longest of them. */
const struct protocol protocol = {
    .baud = 115200, .expects = "a TW-2 with firmware TW2-1, at 115200 baud",
    .cycle_ms = 5, .other_ms = 30, .reply_ms = 12, .quiet_ms = 25, .lost_ms = 150, .kept_ms = 200, .leap = 1ul << 20,
    .proofs = sizeof PROOFS, .others = sizeof OTHERS, .ask = ask, .hear = hear,
    .stop_bytes = 19, .stop = { [11] = REQUEST, 5, DUTY, 0, 0, 0, 0, 0xb7 },
};
