/* What only the ranger board has: three HC-SR04. */
#ifndef GIRAFF_HAL_RANGER_H
#define GIRAFF_HAL_RANGER_H
#include <stdbool.h>
#include <stdint.h>

void hal_start_sonars(void);
void hal_trigger(uint8_t sensor);       /* the pulse a ping begins with */
bool hal_echo_line(uint8_t sensor);

#endif
