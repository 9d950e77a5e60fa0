/* What only the joystick board has: a two-wire bus with the BNO055 on it, and a button. */
#ifndef GIRAFF_HAL_JOYSTICK_H
#define GIRAFF_HAL_JOYSTICK_H
#include <stdbool.h>
#include <stdint.h>

void hal_start_joystick(void);
void hal_hold_sensor_in_reset(bool hold);
bool hal_button(void);              /* true = pressed */

/* One transaction at a time; each runs by interrupts until it is no longer busy. */
enum bus_state { BUS_DONE, BUS_BUSY, BUS_FAILED };

void hal_bus_read(uint8_t address, uint8_t reg, uint8_t *to, uint8_t n);    /* n >= 1 */
void hal_bus_write(uint8_t address, uint8_t reg, uint8_t value);
enum bus_state hal_bus_state(void);
void hal_bus_abort(void);           /* lets go of the bus; the transaction has failed */

#endif
