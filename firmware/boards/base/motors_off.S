/* The first instructions after any reset: ENABLE of all four motor drivers low, before memory is even cleared. */
#include <avr/io.h>
#include "pins.h"

    .section .init1, "ax", @progbits
    cbi _SFR_IO_ADDR(PORTD), MOTOR_A_PWM
    cbi _SFR_IO_ADDR(PORTD), MOTOR_B_PWM
    cbi _SFR_IO_ADDR(PORTD), HEAD_1_PWM
    cbi _SFR_IO_ADDR(PORTD), HEAD_2_PWM
    sbi _SFR_IO_ADDR(DDRD), MOTOR_A_PWM
    sbi _SFR_IO_ADDR(DDRD), MOTOR_B_PWM
    sbi _SFR_IO_ADDR(DDRD), HEAD_1_PWM
    sbi _SFR_IO_ADDR(DDRD), HEAD_2_PWM
