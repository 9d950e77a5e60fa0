/* The Arduino Mega's pins by the numbers that are printed on it: what belongs to each on the ATmega2560, as Arduino's "ATmega2560
 * pin mapping" and the datasheet have it. Left out: 0 and 1, which are USB, and 13, which the boot loader makes blink. */
#ifndef GIRAFF_MEGA_H
#define GIRAFF_MEGA_H

/* Port and bit. */
#define AT_2 E, 4
#define AT_3 E, 5
#define AT_4 G, 5
#define AT_5 E, 3
#define AT_6 H, 3
#define AT_7 H, 4
#define AT_8 H, 5
#define AT_9 H, 6
#define AT_10 B, 4
#define AT_11 B, 5
#define AT_12 B, 6
#define AT_14 J, 1
#define AT_15 J, 0
#define AT_16 H, 1
#define AT_17 H, 0
#define AT_18 D, 3
#define AT_19 D, 2
#define AT_20 D, 1
#define AT_21 D, 0
#define AT_22 A, 0
#define AT_23 A, 1
#define AT_24 A, 2
#define AT_25 A, 3
#define AT_26 A, 4
#define AT_27 A, 5
#define AT_28 A, 6
#define AT_29 A, 7
#define AT_30 C, 7
#define AT_31 C, 6
#define AT_32 C, 5
#define AT_33 C, 4
#define AT_34 C, 3
#define AT_35 C, 2
#define AT_36 C, 1
#define AT_37 C, 0
#define AT_38 D, 7
#define AT_39 G, 2
#define AT_40 G, 1
#define AT_41 G, 0
#define AT_42 L, 7
#define AT_43 L, 6
#define AT_44 L, 5
#define AT_45 L, 4
#define AT_46 L, 3
#define AT_47 L, 2
#define AT_48 L, 1
#define AT_49 L, 0
#define AT_50 B, 3
#define AT_51 B, 2
#define AT_52 B, 1
#define AT_53 B, 0

/* Timer of 16 bits, and its channel. */
#define PWM_AT_2 3, B
#define PWM_AT_3 3, C
#define PWM_AT_5 3, A
#define PWM_AT_6 4, A
#define PWM_AT_7 4, B
#define PWM_AT_8 4, C
#define PWM_AT_11 1, A
#define PWM_AT_12 1, B
#define PWM_AT_44 5, C
#define PWM_AT_45 5, B
#define PWM_AT_46 5, A

/* External interrupt. */
#define INT_AT_2 4
#define INT_AT_3 5
#define INT_AT_18 3
#define INT_AT_19 2
#define INT_AT_20 1
#define INT_AT_21 0

#define PORT(pin) PORT_AT(AT(AT_, pin))
#define DDR(pin) DDR_AT(AT(AT_, pin))
#define PIN(pin) PIN_AT(AT(AT_, pin))
#define BIT(pin) BIT_AT(AT(AT_, pin))

/* Of the timer of a PWM pin: its compare register, and what connects the pin to it. */
#define COMPARE(pin) OCR_AT(AT(PWM_AT_, pin))
#define CONTROL(pin) TCCRA_AT(AT(PWM_AT_, pin))
#define CONTROL_B(pin) TCCRB_AT(AT(PWM_AT_, pin))
#define TOP(pin) ICR_AT(AT(PWM_AT_, pin))
#define COUNTER(pin) TCNT_AT(AT(PWM_AT_, pin))
#define CONNECTED(pin) COM_AT(AT(PWM_AT_, pin))

#define INTERRUPT(pin) AT(INT_AT_, pin)
#define VECTOR(pin) VECTOR_AT(INTERRUPT(pin))

/* The list of a pin becomes arguments only one call further. */
#define AT(what, pin) AT_NUMBER(what, pin)
#define AT_NUMBER(what, number) what##number
#define PORT_AT(...) PORT_OF(__VA_ARGS__)
#define PORT_OF(port, bit) PORT##port
#define DDR_AT(...) DDR_OF(__VA_ARGS__)
#define DDR_OF(port, bit) DDR##port
#define PIN_AT(...) PIN_OF(__VA_ARGS__)
#define PIN_OF(port, bit) PIN##port
#define BIT_AT(...) BIT_OF(__VA_ARGS__)
#define BIT_OF(port, bit) (1 << bit)
#define OCR_AT(...) OCR_OF(__VA_ARGS__)
#define OCR_OF(timer, channel) OCR##timer##channel
#define TCCRA_AT(...) TCCRA_OF(__VA_ARGS__)
#define TCCRA_OF(timer, channel) TCCR##timer##A
#define TCCRB_AT(...) TCCRB_OF(__VA_ARGS__)
#define TCCRB_OF(timer, channel) TCCR##timer##B
#define ICR_AT(...) ICR_OF(__VA_ARGS__)
#define ICR_OF(timer, channel) ICR##timer
#define TCNT_AT(...) TCNT_OF(__VA_ARGS__)
#define TCNT_OF(timer, channel) TCNT##timer
#define COM_AT(...) COM_OF(__VA_ARGS__)
#define COM_OF(timer, channel) (1 << COM##timer##channel##1)
#define VECTOR_AT(number) VECTOR_OF(number)
#define VECTOR_OF(number) INT##number##_vect

#endif
