/* An Arduino with ros_arduino_bridge, by its own source: a loop of PID at 30 Hz, and a stop after 2 s. */
#include "controller_model.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LINE_MAX = 48, FULL = 255, KP = 20, KD = 12, KO = 50 };
const unsigned model_baud = 57600;

static const double FRAME_US = 1e6 / 30, STOPS_US = 2e6;

static struct {
    char line[LINE_MAX];
    int n;
    int asked[MODEL_MOTORS];            /* counts within a frame */
    int is_moving;
    int output[MODEL_MOTORS], had[MODEL_MOTORS];
    int64_t from[MODEL_MOTORS], before[MODEL_MOTORS];
    double frame_us, commanded_us;
} a;

static int64_t count(const struct controller_model *m, int k)
{
    return (int32_t)(m->edges[k] - a.from[k]);
}

static void give(struct controller_model *m, int k, int output)
{
    a.output[k] = output;
    m->duty[k] = output * (double)MODEL_FULL / FULL;
}

static void stop(struct controller_model *m)
{
    a.is_moving = 0;
    for (int k = 0; k < MODEL_MOTORS; k++) {
        give(m, k, 0);
        a.had[k] = a.asked[k] = 0;
    }
}

void model_power_on(struct controller_model *m, double now_us)
{
    memset(&a, 0, sizeof a);
    m->passed_us = now_us;
    a.frame_us = now_us + FRAME_US;
    for (int k = 0; k < MODEL_MOTORS; k++)
        a.from[k] = m->edges[k];
    stop(m);
}

static void hold_speeds(struct controller_model *m)
{
    for (int k = 0; k < MODEL_MOTORS; k++) {
        int got = (int)(count(m, k) - a.before[k]);
        a.before[k] = count(m, k);
        if (!a.is_moving)
            continue;
        int output = a.output[k] + (KP * (a.asked[k] - got) - KD * (got - a.had[k])) / KO;
        a.had[k] = got;
        give(m, k, (int)fmin(fmax(output, -FULL), FULL));
    }
}

void model_pass(struct controller_model *m, double now_us)
{
    double stops_us = a.commanded_us + STOPS_US;
    if (a.is_moving && now_us >= stops_us) {
        model_hold(m, stops_us);
        stop(m);
    }
    while (a.frame_us <= now_us) {
        model_hold(m, a.frame_us);
        hold_speeds(m);
        a.frame_us += FRAME_US;
    }
    model_hold(m, now_us);
}

static int obey(struct controller_model *m, double now_us, char *reply)
{
    int asked[MODEL_MOTORS];
    char end;
    m->packets++;
    if (!strcmp(a.line, "e"))
        return sprintf(reply, "%d %d\r\n", (int)count(m, 0), (int)count(m, 1));
    if (sscanf(a.line, "m %d %d%c", &asked[0], &asked[1], &end) == 2) {
        a.commanded_us = now_us;
        memcpy(a.asked, asked, sizeof asked);
        a.is_moving = asked[0] || asked[1];
        if (!a.is_moving)
            stop(m);
        return sprintf(reply, "OK\r\n");
    }
    if (!strcmp(a.line, "b"))
        return sprintf(reply, "57600\r\n");
    if (!strcmp(a.line, "r")) {
        for (int k = 0; k < MODEL_MOTORS; k++) {
            a.from[k] = m->edges[k];
            a.before[k] = 0;
        }
        return sprintf(reply, "OK\r\n");
    }
    m->packets--;
    m->damaged += a.line[0] != 0;
    return sprintf(reply, "Invalid Command\r\n");
}

int model_on_byte(struct controller_model *m, uint8_t byte, double now_us, uint8_t *reply)
{
    model_pass(m, now_us);
    if (byte != '\r') {
        if (a.n < LINE_MAX - 1)
            a.line[a.n++] = (char)byte;
        return 0;
    }
    a.line[a.n] = 0;
    a.n = 0;
    return obey(m, now_us, (char *)reply);
}
