/* ros_arduino_bridge: a line of text each way. Its own loop holds speeds, in counts of its encoders within 1/30 s, and it
 * stops by itself after 2 s: no command changes or tells that. Source: hbrobotics, "ROSArduinoBridge.ino" and commands.h. */
#include <stdio.h>
#include "controller.h"

enum { LEVEL_FULL = 255, LINE_MAX = 32 };       /* a level is a count within 1/30 s */

static char line[LINE_MAX];
static uint8_t n;
static bool asks_counters;

static int level_of(int16_t duty)
{
    int32_t rounded = duty * (int32_t)LEVEL_FULL + (duty < 0 ? -CONTROLLER_FULL / 2 : CONTROLLER_FULL / 2);
    return (int)(rounded / CONTROLLER_FULL);
}

static uint8_t ask(uint8_t *to, enum step step, uint8_t number, const int16_t duty[CONTROLLER_MOTORS])
{
    n = 0;
    asks_counters = step == STEP_COUNTERS || (step == STEP_PROVE && number == 1);
    if (asks_counters)
        return (uint8_t)snprintf((char *)to, CONTROLLER_REQUEST_MAX, "e\r");
    return (uint8_t)snprintf((char *)to, CONTROLLER_REQUEST_MAX, "m %d %d\r", level_of(duty[0]), level_of(duty[1]));
}

/* A number ends where no digit follows. NULL: there is none. */
static const char *read_number(const char *at, uint32_t *number)
{
    bool minus = *at == '-';
    at += minus;
    if (*at < '0' || *at > '9')
        return NULL;
    for (*number = 0; *at >= '0' && *at <= '9'; at++)
        *number = *number * 10 + (uint32_t)(*at - '0');
    if (minus)
        *number = 0 - *number;
    return at;
}

static enum heard take(void)
{
    if (!asks_counters)
        return line[0] == 'O' && line[1] == 'K' && !line[2] ? HEARD_ALL : HEARD_NOISE;
    uint32_t counters[CONTROLLER_MOTORS];
    const char *at = read_number(line, &counters[0]);
    if (!at || *at != ' ')
        return HEARD_NOISE;
    at = read_number(at + 1, &counters[1]);
    if (!at || *at)
        return HEARD_NOISE;
    controller_tell_counters(counters);
    return HEARD_ALL;
}

static enum heard hear(uint8_t byte)
{
    if (byte == '\r')
        return HEARD_PART;
    if (byte == '\n') {
        line[n] = 0;
        return take();
    }
    line[n++] = (char)byte;
    return n < LINE_MAX - 1 ? HEARD_PART : HEARD_NOISE;
}

const struct protocol protocol = {
    .baud = 57600,
    .expects = "an Arduino with ros_arduino_bridge, at 57600 baud",
    .cycle_ms = 10,
    .reply_ms = 30,
    .quiet_ms = 30,
    .lost_ms = 200,
    .leap = 1ul << 11,           /* a level of 255 is 1530 counts within lost_ms */
    .proofs = 2,
    .ask = ask,
    .hear = hear,
    .stop_bytes = 7,
    .stop = { '\r', 'm', ' ', '0', ' ', '0', '\r' },
};
