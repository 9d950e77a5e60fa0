/* A TW-2 as its paper has it: "TW-2 dual motor controller: serial protocol". */
#include "controller_model.h"

#include <string.h>

enum { TO_IT = 0xa5, FROM_IT = 0x5a, THOUSANDTHS = 1000, HUNDREDTHS_MOST = 100, FRAME_MOST = 258 };
static const double FORGETS_US = 20e3, HUNDREDTH_US = 10e3;
static const char FIRMWARE[] = "TW2-1.3";

const unsigned model_baud = 115200;

static struct {
    uint8_t frame[FRAME_MOST];
    unsigned n;                                 /* bytes of the frame so far */
    double byte_us;                             /* of the newest byte */
    uint8_t watchdog;                           /* hundredths of a second; 0 = off */
    double fed_us;                              /* newest answered frame */
    uint32_t counter_at_0[MODEL_MOTORS];        /* its counter, were the encoder at edge 0 */
} it;

static void outputs_off(struct controller_model *m)
{
    memset(m->duty, 0, sizeof m->duty);
}

void model_power_on(struct controller_model *m, double now_us)
{
    outputs_off(m);
    m->passed_us = now_us;
    memset(&it, 0, sizeof it);
    it.byte_us = it.fed_us = now_us;
    for (int i = 0; i < MODEL_MOTORS; i++)
        it.counter_at_0[i] = 0u - (uint32_t)m->edges[i];
}

void model_pass(struct controller_model *m, double now_us)
{
    if (m->is_pressed)
        outputs_off(m);
    double ends_us = it.fed_us + it.watchdog * HUNDREDTH_US;
    if (it.watchdog && now_us >= ends_us) {
        if (ends_us > m->passed_us)
            model_hold(m, ends_us);
        outputs_off(m);
    }
    model_hold(m, now_us);
}

static uint32_t little(const uint8_t *from, int bytes)
{
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint32_t)from[i] << 8 * i;
    return value;
}

static int put(uint8_t *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> 8 * i);
    return bytes;
}

/* What follows the letter in the answer; -1 = none. */
static int answer(struct controller_model *m, uint8_t letter, const uint8_t *data, unsigned bytes, uint8_t *to)
{
    if (letter == 'V' && bytes == 0) {
        memcpy(to, FIRMWARE, sizeof FIRMWARE - 1);
        return sizeof FIRMWARE - 1;
    }
    if (letter == 'D' && bytes == 2 * MODEL_MOTORS) {
        int16_t asked[MODEL_MOTORS];
        for (int i = 0; i < MODEL_MOTORS; i++) {
            asked[i] = (int16_t)little(data + 2 * i, 2);
            if (asked[i] < -THOUSANDTHS || asked[i] > THOUSANDTHS)
                return -1;
        }
        for (int i = 0; i < MODEL_MOTORS && !m->is_pressed; i++)
            m->duty[i] = (double)asked[i] * MODEL_FULL / THOUSANDTHS;
        return 0;
    }
    if (letter == 'C' && bytes == 0) {
        for (int i = 0; i < MODEL_MOTORS; i++)
            put(to + 4 * i, it.counter_at_0[i] + (uint32_t)m->edges[i], 4);
        return 4 * MODEL_MOTORS;
    }
    if (letter == 'P' && bytes == 4 * MODEL_MOTORS) {
        for (int i = 0; i < MODEL_MOTORS; i++)
            it.counter_at_0[i] = little(data + 4 * i, 4) - (uint32_t)m->edges[i];
        return 0;
    }
    if (letter == 'W' && bytes <= 1) {
        if (bytes && data[0] > HUNDREDTHS_MOST)
            return -1;
        if (bytes)
            it.watchdog = data[0];
        return put(to, it.watchdog, 1);
    }
    if (letter == 'B' && bytes == 0)
        return put(to, (uint32_t)(m->volts * 100 + 0.5), 2);
    if (letter == 'E' && bytes == 0)
        return put(to, m->is_pressed != 0, 1);
    return -1;
}

static uint8_t sum_of(const uint8_t *from, unsigned bytes)
{
    unsigned sum = 0;
    while (bytes--)
        sum += *from++;
    return (uint8_t)sum;
}

int model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply)
{
    model_pass(m, now_us);
    if (it.n && now_us - it.byte_us >= FORGETS_US) {
        it.n = 0;
        m->damaged++;
    }
    it.byte_us = now_us;
    if (it.n == 0 && byte != TO_IT) {
        m->damaged++;
        return 0;
    }
    it.frame[it.n++] = byte;
    if (it.n < 3 || it.n < it.frame[1] + 3u)
        return 0;
    unsigned payload = it.frame[1];
    int right = payload && sum_of(it.frame + 1, it.n - 1) == 0;
    it.n = 0;
    int bytes = right ? answer(m, it.frame[2], it.frame + 3, payload - 1, reply + 3) : -1;
    if (bytes < 0) {
        m->damaged++;
        return 0;
    }
    m->packets++;
    it.fed_us = now_us;
    reply[0] = FROM_IT;
    reply[1] = (uint8_t)(bytes + 1);
    reply[2] = it.frame[2];
    reply[bytes + 3] = (uint8_t)(0u - sum_of(reply + 1, (unsigned)bytes + 2));
    return bytes + 4;
}
