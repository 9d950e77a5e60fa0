/* Three HC-SR04, pinged one at a time. */
#ifndef GIRAFF_SONARS_H
#define GIRAFF_SONARS_H
#include <stdbool.h>
#include <stdint.h>
#include "echo.h"
#include "tick.h"

void sonars_start(void);

/* Begins a ping, unless the sensor's last one is still under way. */
void sonars_ping(uint8_t sensor);

struct sonar_result {
    uint32_t pinged_us;
    struct held_tick tick;      /* held at the trigger */
    struct verdict verdict;
};

/* Whether the sensor's ping has come to a result, which is given once. */
bool sonars_result(uint8_t sensor, struct sonar_result *result);

/* From the interrupt at each edge of the sensor's echo line, with its level just after it. */
void sonars_on_edge(uint8_t sensor, bool high);

#endif
