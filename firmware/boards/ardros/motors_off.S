/* The first instructions after any reset: both servo lines low, so that the motor driver sees no pulse. */
#include <avr/io.h>
#include "pins.h"

    .section .init1, "ax", @progbits
    cbi _SFR_IO_ADDR(PORTE), SERVO_0
    cbi _SFR_IO_ADDR(PORTE), SERVO_1
    sbi _SFR_IO_ADDR(DDRE), SERVO_0
    sbi _SFR_IO_ADDR(DDRE), SERVO_1
