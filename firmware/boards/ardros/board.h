#ifndef GIRAFF_BOARD_H
#define GIRAFF_BOARD_H
#include "base_on_mega.h"
#include "boards.h"

#define BOARD_KIND ARDROS_BOARD

/* Servo pulses to the motor driver. Its dead band about neutral is not published: a pulse begins to differ from neutral
 * at once, and the session's dead_pwm is what it takes to turn a wheel. */
enum { PULSE_FRAME_MS = 20, PULSE_NEUTRAL_US = 1500, PULSE_DEAD_US = 0, PULSE_SPAN_US = 500 };

#define HAS_LEVEL_LIMIT 1           /* a potentiometer */
#define HAS_TRANSITIONS 0           /* port A, where the B channels are, has no such interrupt */

#endif
