/* The inside of the lockstep library: one AVR core of simavr 1.6, run slice by slice, with what surrounds its
 * pins. A cure of one of simavr's traps is marked TRAP where it stands.
 */
#ifndef GIRAFF_LOCKSTEP_INSIDE_H
#define GIRAFF_LOCKSTEP_INSIDE_H
#include <stddef.h>
#include <stdint.h>
#include "sim_avr.h"
#include "avr_ioport.h"
#include "avr_timer.h"
#include "avr_twi.h"
#include "avr_uart.h"
#include "board_model.h"
#include "protocol.h"

enum {
    TX_SIZE = 65536,
    RX_SIZE = 256,              /* what a USB serial adapter holds; the rest waits in the host's kernel */
    MESSAGE_SIZE = 160
};

struct pin {
    avr_ioport_t *port;         /* NULL: not connected */
    int bit;
};

struct motor {
    struct board_model *board;
    int number;                 /* of board->motor */
    int forward;                /* level of PHASE that means forward */
    int mirrored;               /* the encoder's B channel is inverted: forward is the other way round */
    struct pin encoder_a, encoder_b, pwm, phase;
    avr_timer_comp_t *compare;  /* of the PWM output */
    int duty;                   /* on the pins now, signed */
    int64_t duty_cycles;        /* sum over the slice of duty * cycles it lasted */
    avr_cycle_count_t since;    /* cycle from which `duty` is not yet in the sum */
    int was_cut;                /* encoder_cut of the slice before */
    double from, to;            /* encoder position at the ends of the running slice, quadrature states */
};

struct sonar {
    struct board_model *board;
    int number;                 /* of board->pings */
    struct pin trigger, echo;
    int trigger_level;
    avr_cycle_count_t trigger_rose;
    enum { SONAR_IDLE, SONAR_PINGED, SONAR_ECHOING, SONAR_STUCK } state;
    avr_cycle_count_t due;      /* of the next change of the echo line, when pinged or echoing */
};

struct board_private {
    avr_t *avr;
    void (*core_reset)(avr_t *);
    int was_reset;              /* the pins and timers wait to be restored */
    avr_cycle_count_t start, end;   /* of the running slice */
    avr_uart_t *uart;
    int receiver_full;
    uint8_t tx[TX_SIZE], rx[RX_SIZE];
    unsigned rx_head, rx_tail;
    avr_twi_t *twi;
    avr_irq_t *twi_input;
    uint8_t twi_selected;       /* address byte of the running transfer; 0 = not for the slave */
    int twi_index;              /* of the byte within the transfer */
    uint8_t twi_pointer;
    avr_irq_t *battery;         /* NULL: none wired */
    int battery_mv;
    struct pin button, slave_reset, bumper[BOARD_BUMPERS];
    struct motor motor[BOARD_MOTORS];
    struct sonar sonar[BOARD_SONARS];
};

static inline struct board_model *board_of(avr_t *avr) { return avr->custom.data; }

/* open.c */
avr_io_t *io_next(avr_t *avr, const char *kind, avr_io_t *after);

/* pins.c: levels driven from outside survive a reset of the core */
struct pin pin_named(avr_t *avr, const char *name);     /* "D3" */
void pin_drive(struct board_model *b, struct pin pin, int level);
int pin_output(avr_t *avr, struct pin pin);             /* level, or -1 while the pin is an input */
void pins_restore(avr_t *avr);

/* motors.c */
struct motor_wiring {
    char timer, channel;
    const char *pwm, *phase, *encoder_a, *encoder_b;
    int forward, mirrored;
};
int motor_wire(struct board_model *b, int number, const struct motor_wiring *wiring);    /* 0, or -1 */
void motors_begin(struct board_model *b);               /* a slice */
void motors_arm(struct board_model *b);
void motors_restore(struct board_model *b);
void motors_end(struct board_model *b, avr_cycle_count_t cycles);
void motors_stand_still(struct board_model *b);         /* the core is stopped: nobody counts */

/* sonar.c */
void sonar_wire(struct board_model *b, int number, const char *trigger, const char *echo);
void sonars_arm(struct board_model *b);

/* twi.c */
int twi_wire(struct board_model *b);                    /* 0, or -1 */
void twi_restore(struct board_model *b);

/* uart.c */
int uart_wire(struct board_model *b);                   /* 0, or -1 */
void uart_arm(struct board_model *b);
void uart_restore(struct board_model *b);

#endif
