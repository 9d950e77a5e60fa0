/* A RoboClaw, by Basicmicro's "RoboClaw User Manual". */
#include "controller_model.h"
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { ADDRESS = 0x80, ACKNOWLEDGED = 0xff, FORGETS_US = 10000 };
const unsigned model_baud = 115200;

static const double FASTEST = 655359;           /* of the duty, in a second */
static const char VERSION[] = "USB Roboclaw 2x15a v4.2.4\n";

static struct {
    double target[MODEL_MOTORS];
    double rate[MODEL_MOTORS];          /* of the duty, in a second */
    int64_t counts_from[MODEL_MOTORS];
    uint8_t timeout_tenths;             /* of a second; 0 = none, as after its power was off */
    double heard_us;
    uint8_t packet[32], n;
} r;

/* Of what sets something, the bytes of its data; it has a CRC and is acknowledged. */
static int data_bytes(uint8_t command)
{
    switch (command) {
    case 14:                            /* serial time-out */
        return 1;
    case 22:                            /* counter of either encoder */
    case 23:
    case 34:                            /* duty of both motors */
        return 4;
    case 54:                            /* the same, each with an acceleration */
        return 12;
    default:
        return -1;
    }
}

static uint16_t crc_of(const uint8_t *bytes, int n, uint16_t crc)
{
    for (int i = 0; i < n; i++) {
        crc ^= (uint16_t)(bytes[i] << 8);
        for (int bit = 0; bit < 8; bit++)
            crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
    }
    return crc;
}

static int64_t number_at(const uint8_t *from, int bytes)
{
    int64_t value = 0;
    while (bytes--)
        value = value << 8 | *from++;
    return value;
}

static int put(uint8_t *to, int64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> 8 * (bytes - 1 - i));
    return bytes;
}

void model_power_on(struct controller_model *m, double now_us)
{
    for (int k = 0; k < MODEL_MOTORS; k++) {
        m->duty[k] = r.target[k] = 0;
        r.rate[k] = FASTEST;
        r.counts_from[k] = m->edges[k];
    }
    r.timeout_tenths = 0;
    r.n = 0;
    m->passed_us = r.heard_us = now_us;
}

/* In steps so small that its mean is right. */
static void ramp(struct controller_model *m, double until_us)
{
    enum { STEP_US = 100 };
    while (m->passed_us < until_us) {
        double to_us = fmin(m->passed_us + STEP_US, until_us), us = to_us - m->passed_us;
        for (int k = 0; k < MODEL_MOTORS; k++) {
            double step = r.rate[k] * us * 1e-6;
            m->duty[k] += fmin(fmax(r.target[k] - m->duty[k], -step), step);
            if (m->is_pressed)
                m->duty[k] = r.target[k] = 0;
        }
        model_hold(m, to_us);
    }
}

void model_pass(struct controller_model *m, double now_us)
{
    double lost_us = r.heard_us + r.timeout_tenths * 100000.0;
    if (r.timeout_tenths && now_us >= lost_us) {
        ramp(m, lost_us);
        memset(m->duty, 0, sizeof m->duty);
        memset(r.target, 0, sizeof r.target);
    }
    ramp(m, now_us);
}

static void set_duty(int motor, const uint8_t *duty, double rate)
{
    r.target[motor] = (int16_t)number_at(duty, 2);
    r.rate[motor] = rate;
}

static void obey(struct controller_model *m)
{
    const uint8_t *data = r.packet + 2;
    switch (r.packet[1]) {
    case 14:
        r.timeout_tenths = data[0];
        break;
    case 22:
    case 23:
        r.counts_from[r.packet[1] - 22] = m->edges[r.packet[1] - 22] - number_at(data, 4);
        break;
    case 34:
        for (int k = 0; k < MODEL_MOTORS; k++)
            set_duty(k, data + 2 * k, FASTEST);
        break;
    case 54:
        for (int k = 0; k < MODEL_MOTORS; k++)
            set_duty(k, data + 6 * k, (double)number_at(data + 6 * k + 2, 4));
        break;
    }
}

static int64_t count(const struct controller_model *m, int encoder)
{
    return m->edges[encoder] - r.counts_from[encoder];
}

/* Bytes of the answer, without its CRC; 0 = it does not know the command. */
static int answer(const struct controller_model *m, uint8_t command, uint8_t *to)
{
    switch (command) {
    case 15:
        return put(to, r.timeout_tenths, 1);
    case 16:                            /* counter of either encoder, and a status of it */
    case 17:
        return put(to, count(m, command - 16), 4) + put(to + 4, 0, 1);
    case 21:
        memcpy(to, VERSION, sizeof VERSION);
        return sizeof VERSION;
    case 24:
        return put(to, lround(m->volts * 10), 2);
    case 78:
        return put(to, count(m, 0), 4) + put(to + 4, count(m, 1), 4);
    case 90:
        return put(to, m->is_pressed != 0, 4);
    default:
        return 0;
    }
}

static void forget_first(int bytes)
{
    r.n = (uint8_t)(r.n - bytes);
    memmove(r.packet, r.packet + bytes, r.n);
}

int model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply)
{
    model_pass(m, now_us);
    if (r.n && now_us - r.heard_us > FORGETS_US) {
        m->damaged++;
        r.n = 0;
    }
    r.heard_us = now_us;               /* whatever came */
    r.packet[r.n++] = byte;
    while (r.n >= 2) {
        int size = data_bytes(r.packet[1]), n = r.packet[0] == ADDRESS ? answer(m, r.packet[1], reply) : 0;
        if (n) {
            put(reply + n, crc_of(reply, n, crc_of(r.packet, 2, 0)), 2);
            forget_first(2);
            m->packets++;
            return n + 2;
        }
        if (r.packet[0] != ADDRESS || size < 0) {
            m->damaged++;
            forget_first(1);
            continue;
        }
        if (r.n < size + 4)
            return 0;
        bool is_whole = crc_of(r.packet, size + 2, 0) == number_at(r.packet + size + 2, 2);
        if (is_whole)
            obey(m);
        forget_first(size + 4);
        if (is_whole) {
            m->packets++;
            reply[0] = ACKNOWLEDGED;
            return 1;
        }
        m->damaged++;
    }
    return 0;
}
