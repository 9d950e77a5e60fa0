/* What only the ranger board has: three HC-SR04, and pins for bumpers. */
#ifndef GIRAFF_HAL_RANGER_H
#define GIRAFF_HAL_RANGER_H
#include <stdbool.h>
#include <stdint.h>

void hal_start_sonars(void);
void hal_trigger(uint8_t sensor);       /* the pulse a ping begins with */
bool hal_echo_line(uint8_t sensor);

void hal_start_bumpers(void);
bool hal_bumper_is_open(uint8_t bumper);    /* also when nothing is on its pin */

#endif
