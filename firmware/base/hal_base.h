/* What only a base board has: two motors' drivers, two encoders, a battery to measure. */
#ifndef GIRAFF_HAL_BASE_H
#define GIRAFF_HAL_BASE_H
#include <stdbool.h>
#include <stdint.h>

void hal_start_motors(void);
void hal_start_encoders(void);
void hal_start_battery(void);

/* Where board.h has HAS_TRANSITIONS: from now on each change of this encoder calls transitions_on_change; of none for a
 * number that no encoder has. */
void hal_watch_encoder(uint8_t encoder);

/* Motors by number: 0 is motor A, 1 is motor B. By PWM, off disconnects it, and its pin is low at once; by servo pulses,
 * off is neutral from the next frame on. */
void hal_motor_off(uint8_t motor);
void hal_motor_direction(uint8_t motor, bool forward);  /* while it is off only */
void hal_motor_pwm(uint8_t motor, uint8_t counts);      /* of 255; connects PWM */

uint16_t hal_battery_counts(void);      /* newest conversion, 10 bit of AVCC; begins the next */
uint8_t hal_level_limit(void);          /* where board.h has HAS_LEVEL_LIMIT: share of the levels allowed, of 255;
                                         * also from interrupts */

#endif
