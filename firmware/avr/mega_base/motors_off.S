/* The first instructions after any reset: all that goes to a motor driver low, before memory is even cleared. */
#include <avr/io.h>
#include DRIVER
#include "mega.h"
#include "pins.h"

    .macro low port, ddr, bit
    lds r24, \port
    andi r24, 0xff - (\bit)
    sts \port, r24
    lds r24, \ddr
    ori r24, \bit
    sts \ddr, r24
    .endm
#define LOW(pin) low _SFR_MEM_ADDR(PORT(pin)), _SFR_MEM_ADDR(DDR(pin)), BIT(pin) $

    .section .init1, "ax", @progbits
    EACH_OUTPUT(LOW)
