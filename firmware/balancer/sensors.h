/* Means of the analogue sensors over each control period. */
#ifndef GIRAFF_SENSORS_H
#define GIRAFF_SENSORS_H
#include <stdint.h>

enum sensor { GYROSCOPE_0, GYROSCOPE_1, FORWARD, UP, BATTERY, SENSORS };

void sensors_take(float means[SENSORS]);        /* since the last call, in ADC counts */

void sensors_on_conversion(uint8_t sensor, uint16_t counts);    /* from the converter's interrupt */

#endif
