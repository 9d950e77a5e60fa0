/* NAME_terminal LINK: the model of a motor controller on a pseudo terminal, in real time, with two motors of a robot that drives.
 *
 * A line on stdin is what happens to it:
 *   cut, plug      the plug of its USB cable
 *   mute, pass     no byte passes, without an error
 *   hold, pass     an adapter keeps the bytes back, and delivers them later
 *   off, on        its power
 *   press, free    its emergency input
 *   block N, free N    the wheel at motor N
 *   truth          asks for its state
 * A line on stdout is a JSON object: each change of a duty, each event and each answer. "t" is the time of
 * CLOCK_MONOTONIC in s.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <sched.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>
#include "controller_model.h"

enum { PRIORITY = 30, STEP_US = 1000, TURN_AROUND_US = 1000, HELD_MAX = 65536, REPLIES = 64, PATH_SIZE = 4096 };
static const double EDGES_PER_M = 8000, TOP_SPEED = 2.19, TAU_US = 150000, FRICTION_SPEED = 0.005;

struct reply {
    double due_us;
    uint8_t bytes[MODEL_REPLY_MAX];
    size_t n;
};

static const char *link_path;
static int master = -1, slave = -1;
static struct controller_model controller = { .volts = 24 };
static bool is_off, is_mute, is_held, is_blocked[MODEL_MOTORS];
static double speed[MODEL_MOTORS], position[MODEL_MOTORS];        /* m/s, m */
static long told_duty[MODEL_MOTORS];
static uint8_t held[HELD_MAX];
static size_t held_n;
static struct reply replies[REPLIES];
static unsigned first, next;                    /* of the replies under way */
static double passed_us;                        /* until when all of this has gone */
static double late_us;                          /* the longest that it stood still, in which no byte was taken */

static double clock_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e6 + (double)now.tv_nsec * 1e-3;
}

static void require(bool done, const char *what)
{
    if (done)
        return;
    perror(what);
    exit(EXIT_FAILURE);
}

static void plug(void)
{
    struct termios raw;
    char fresh[PATH_SIZE];
    master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    require(master >= 0 && !grantpt(master) && !unlockpt(master), "terminal");
    slave = open(ptsname(master), O_RDWR | O_NOCTTY);
    require(slave >= 0 && !tcgetattr(slave, &raw), "terminal");
    cfmakeraw(&raw);
    tcsetattr(slave, TCSANOW, &raw);
    snprintf(fresh, sizeof fresh, "%s.new", link_path);
    unlink(fresh);
    require(!symlink(ptsname(master), fresh) && !rename(fresh, link_path), link_path);
}

static void cut(void)
{
    unlink(link_path);
    close(slave);
    close(master);
    master = slave = -1;
    first = next;
    held_n = 0;
}

static void tell_duty(void)
{
    long duty[MODEL_MOTORS];
    for (int k = 0; k < MODEL_MOTORS; k++)
        duty[k] = lround(controller.duty[k]);
    if (memcmp(duty, told_duty, sizeof duty) != 0)
        printf("{\"t\": %.6f, \"duty\": [%ld, %ld]}\n", passed_us * 1e-6, duty[0], duty[1]);
    memcpy(told_duty, duty, sizeof duty);
}

static void tell_truth(void)
{
    printf("{\"t\": %.6f, \"truth\": {\"speed\": [%.4f, %.4f], \"position\": [%.4f, %.4f], \"packets\": %u, "
           "\"damaged\": %u, \"late\": %.4f}}\n", passed_us * 1e-6, speed[0], speed[1], position[0], position[1],
           controller.packets, controller.damaged, late_us * 1e-6);
}

static void turn_wheel(int k, double us)
{
    double goal = controller.duty[k] / MODEL_FULL * TOP_SPEED;
    speed[k] += (goal - speed[k]) * fmin(1, us / TAU_US);
    if (is_blocked[k] || (goal == 0 && fabs(speed[k]) < FRICTION_SPEED))
        speed[k] = 0;
    position[k] += speed[k] * us * 1e-6;
    controller.edges[k] = (int64_t)floor(position[k] * EDGES_PER_M);
}

/* In steps, however late this process is: a time-out is told when it was. */
static void pass_until(double now_us)
{
    late_us = fmax(late_us, now_us - passed_us - STEP_US);
    while (passed_us < now_us) {
        double us = fmin(STEP_US, now_us - passed_us);
        passed_us += us;
        model_pass(&controller, passed_us);
        for (int k = 0; k < MODEL_MOTORS; k++)
            turn_wheel(k, us);
        tell_duty();
    }
}

static void hear(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n && !is_off && next - first < REPLIES; i++) {
        struct reply *reply = &replies[next % REPLIES];
        reply->n = (size_t)model_on_byte(&controller, bytes[i], passed_us, reply->bytes);
        reply->due_us = passed_us + TURN_AROUND_US + (double)(n + reply->n) * 10e6 / model_baud;
        next += reply->n > 0;
    }
    tell_duty();
}

static void take_from_host(void)
{
    uint8_t bytes[1024];
    ssize_t n = read(master, bytes, sizeof bytes);
    if (n <= 0 || is_mute)
        return;
    if (!is_held) {
        hear(bytes, (size_t)n);
    } else if (held_n + (size_t)n <= HELD_MAX) {
        memcpy(held + held_n, bytes, (size_t)n);
        held_n += (size_t)n;
    }
}

static void answer_host(void)
{
    while (first != next && !is_held && replies[first % REPLIES].due_us <= passed_us) {
        const struct reply *reply = &replies[first++ % REPLIES];
        if (!is_mute && write(master, reply->bytes, reply->n) < 0)
            return;             /* nobody reads, and it is lost */
    }
}

static void pass(void)
{
    is_held = is_mute = false;
    hear(held, held_n);
    held_n = 0;
}

static void set_power(bool on)
{
    is_off = !on;
    model_power_on(&controller, passed_us);
    tell_duty();
}

static void obey(char *line)
{
    char word[16] = "";
    int wheel = -1;
    line[strcspn(line, "\n")] = 0;
    sscanf(line, "%15s %d", word, &wheel);
    bool is_wheel = wheel >= 0 && wheel < MODEL_MOTORS, is_known = true;
    if (!strcmp(word, "truth")) {
        tell_truth();
        return;
    }
    if (!strcmp(word, "cut") && master >= 0)
        cut();
    else if (!strcmp(word, "plug") && master < 0)
        plug();
    else if (!strcmp(word, "mute"))
        is_mute = true;
    else if (!strcmp(word, "hold"))
        is_held = true;
    else if (!strcmp(word, "pass"))
        pass();
    else if (!strcmp(word, "off") || !strcmp(word, "on"))
        set_power(!strcmp(word, "on"));
    else if (is_wheel && (!strcmp(word, "block") || !strcmp(word, "free")))
        is_blocked[wheel] = !strcmp(word, "block");
    else if (!strcmp(word, "press") || !strcmp(word, "free"))
        controller.is_pressed = !strcmp(word, "press");
    else
        is_known = false;
    printf("{\"t\": %.6f, \"%s\": \"%s\"}\n", passed_us * 1e-6, is_known ? "event" : "unknown", line);
}

int main(int n, char **words)
{
    char line[64];
    const struct sched_param hardware = { .sched_priority = PRIORITY };
    if (n != 2) {
        fprintf(stderr, "usage: NAME_terminal LINK\n");
        return 2;
    }
    link_path = words[1];
    sched_setscheduler(0, SCHED_FIFO, &hardware);       /* where it may: no other process delays a controller */
    setvbuf(stdin, NULL, _IONBF, 0);
    setvbuf(stdout, NULL, _IOLBF, 0);
    passed_us = clock_us();
    set_power(true);
    plug();
    for (;;) {
        struct pollfd from[] = { { .fd = master, .events = POLLIN }, { .fd = STDIN_FILENO, .events = POLLIN } };
        const struct timespec step = { 0, STEP_US * 1000 };
        ppoll(from, 2, &step, NULL);
        pass_until(clock_us());
        if (from[0].revents & POLLIN)
            take_from_host();
        answer_host();
        if (slave >= 0)
            ioctl(slave, TIOCNXCL);     /* on a pseudo terminal it would outlast who asks for it */
        if (from[1].revents && !fgets(line, sizeof line, stdin))
            break;
        if (from[1].revents)
            obey(line);
    }
    unlink(link_path);
    return 0;
}
