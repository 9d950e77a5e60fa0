/* Transactions with a time limit on the two-wire bus: whatever its other side does, each comes to an end. */
#ifndef GIRAFF_BUS_H
#define GIRAFF_BUS_H
#include <stdint.h>
#include "hal_joystick.h"

void bus_read(uint8_t address, uint8_t reg, uint8_t *to, uint8_t n, uint32_t now_ms);
void bus_write(uint8_t address, uint8_t reg, uint8_t value, uint32_t now_ms);
enum bus_state bus_poll(uint32_t now_ms);

#endif
