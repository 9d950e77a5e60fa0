#include "clock.h"
#include "hal.h"
#include "hal_ranger.h"
#include "protocol.h"
#include "sonars.h"

static struct sonar {
    bool pinged;                /* and no result yet */
    bool doubtful;              /* as echo_judge has it */
    uint32_t pinged_us;
    struct held_tick tick;
} sonars[RANGE_SENSORS];

static volatile struct echo echoes[RANGE_SENSORS];      /* written by interrupts */

void sonars_start(void)
{
    hal_start_sonars();
}

void sonars_ping(uint8_t sensor)
{
    struct sonar *sonar = &sonars[sensor];
    if (sonar->pinged)
        return;
    ATOMICALLY {
        echoes[sensor].rose = echoes[sensor].fell = false;
    }
    sonar->pinged = true;
    sonar->tick = tick_newest();
    sonar->pinged_us = clock_us();
    hal_trigger(sensor);        /* also when the line is stuck: a sensor that is well again answers */
}

bool sonars_result(uint8_t sensor, struct sonar_result *result)
{
    struct sonar *sonar = &sonars[sensor];
    if (!sonar->pinged)
        return false;
    struct echo echo;
    bool high;
    ATOMICALLY {
        echo = echoes[sensor];
        high = hal_echo_line(sensor);
    }
    struct verdict verdict = echo_judge(&echo, high, sonar->doubtful, sonar->pinged_us, clock_us());
    if (verdict.what == PENDING)
        return false;
    sonar->pinged = false;
    sonar->doubtful = verdict.next_is_doubtful;
    *result = (struct sonar_result){ .pinged_us = sonar->pinged_us, .tick = sonar->tick, .verdict = verdict };
    return verdict.what == KNOWN;
}

void sonars_on_edge(uint8_t sensor, bool high)
{
    volatile struct echo *echo = &echoes[sensor];
    if (high) {
        echo->rose_us = clock_us();
        echo->rose = true;
        echo->fell = false;
    } else if (echo->rose) {    /* else the end of a pulse that began before the ping */
        echo->fell_us = clock_us();
        echo->fell = true;
    }
}
