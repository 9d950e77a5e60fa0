/* What only a balancing robot's board has: analogue sensors, two encoders, a motor driver on a serial line, a cord. */
#ifndef GIRAFF_HAL_BALANCER_H
#define GIRAFF_HAL_BALANCER_H
#include <stdbool.h>
#include <stdint.h>

void hal_start_sensors(void);           /* sensors_on_conversion from now on */
void hal_start_encoders(void);          /* encoders_on_change from now on */
uint8_t hal_encoder_pins(void);         /* bit 0: channel A of encoder 0; then its B, A and B of encoder 1 */
void hal_start_driver(void);
void hal_driver_transmit(void);         /* fetch bytes by driver_on_transmit until it has none; interrupts off */
void hal_start_cord(void);
bool hal_cord_is_pulled(void);

#endif
