/* The motor driver, a Sabertooth on a serial line that it never answers: packets each control period. */
#ifndef GIRAFF_DRIVER_H
#define GIRAFF_DRIVER_H
#include <stdbool.h>
#include <stdint.h>

void driver_start(void);
void driver_cut_off_below(uint16_t mv);         /* of the session */

/* Send the motors' commands, of DRIVER_FULL, forward positive. While it rests the driver is told its settings again,
 * too, since one that was off has forgotten them, its baud and its time-out included. */
void driver_send(const int8_t motor[2], bool rests);

int16_t driver_on_transmit(void);               /* from the line's interrupt: the next byte to go out, or -1 */

#endif
