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
#include "sabertooth_driver.h"
#include "servo_driver.h"

enum {
    TX_SIZE = 65536,
    RX_SIZE = 256,              /* what a USB serial adapter holds; the rest waits in the host's kernel */
    DRIVER_BYTES = 4,           /* of an AVR's transmitter: one shifts, one waits */
    BRIDGE_INPUTS = 4,
    MESSAGE_SIZE = 160
};

struct pin {
    avr_ioport_t *port;         /* NULL: not connected */
    int bit;
};

struct encoder {
    struct board_model *board;
    int number;                 /* of board->motor */
    int mirrored;               /* channel B is inverted: forward is the other way round */
    struct pin a, b;
    int was_cut;                /* encoder_cut of the slice before */
    double from, to;            /* encoder position at the ends of the running slice, quadrature states */
};

struct bridge_input {
    struct pin pin;
    avr_timer_comp_t *compare;  /* NULL: the pin has no compare unit */
    uint16_t width, top;        /* that register and ICR, as they were last written whole */
};

struct bridge {                 /* an H bridge, with all its inputs */
    struct motor_model *motor;  /* NULL: none wired */
    int (*drive)(const int *levels);    /* its signed duty, by those of its inputs: each 0 to 255 */
    struct bridge_input input[BRIDGE_INPUTS];
    int duty;                   /* on the pins now, signed */
    int64_t duty_cycles;        /* sum over the slice of duty * cycles it lasted */
    avr_cycle_count_t since;    /* cycle from which `duty` is not yet in the sum */
};

struct servo {                  /* a servo output to a motor driver in R/C mode */
    struct servo_driver driver;
    struct pin pin;
    avr_timer_comp_t *compare;
    int level;                  /* of the compare unit */
    uint16_t next;              /* the compare register, as the next frame takes it */
};

struct driver_line {            /* the serial line to a motor driver */
    struct sabertooth_driver driver;
    avr_uart_t *uart;
    uint8_t bytes[DRIVER_BYTES];        /* on their way, from tail to head */
    unsigned head, tail;
};

struct analog {                 /* a voltage at an ADC channel */
    avr_irq_t *input;           /* NULL: none wired */
    int parts;                  /* of a volt */
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
    avr_cycle_count_t slept;    /* of the running slice */
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
    int parts_per_volt;         /* of the analogue inputs and their reference */
    struct analog battery, limit, sensor[BOARD_SENSORS];
    struct pin button, slave_reset, bumper[BOARD_BUMPERS], cord;
    struct encoder encoder[BOARD_MOTORS];
    struct bridge bridge[BOARD_MOTORS];
    struct pin enable[BOARD_MOTORS];    /* high: the bridge may drive */
    struct servo servo[BOARD_MOTORS];
    struct driver_line driver_line;
    struct sonar sonar[BOARD_SONARS];
};

static inline struct board_model *board_of(avr_t *avr) { return avr->custom.data; }

/* pins.c: what the processor has, by name; and levels driven from outside, which survive a reset of the core */
avr_io_t *io_next(avr_t *avr, const char *kind, avr_io_t *after);
avr_timer_t *timer_named(avr_t *avr, char name);        /* NULL: the processor has none */
struct pin pin_named(avr_t *avr, const char *name);     /* "D3" */
void pin_drive(struct board_model *b, struct pin pin, int level);
int pin_output(avr_t *avr, struct pin pin);             /* level, or -1 while the pin is an input */
void pins_restore(avr_t *avr);
void register_watch(avr_t *avr, avr_io_addr_t address, avr_irq_notify_t changed, void *param);
void pin_watch(avr_t *avr, struct pin pin, avr_irq_notify_t changed, void *param);      /* as an output */

/* encoders.c, bridges.c, servos.c. begin and end: of a slice. stand_still: a slice of a stopped core. */
void encoder_wire(struct board_model *b, int number, const char *pin_a, const char *pin_b, int mirrored);
void encoders_begin(struct board_model *b);
void encoders_arm(struct board_model *b);
void encoders_stand_still(struct board_model *b);

struct bridge_wiring {
    int (*drive)(const int *levels);
    const char *pins[BRIDGE_INPUTS];    /* in the order that `drive` takes */
};
int a3959_drive(const int *levels);         /* PWM; PHASE, high = forward */
int a3959_drive_mirrored(const int *levels);
int l298n_drive(const int *levels);         /* PWM, IN1, IN2; of a TB6612FNG as well */
int bts7960_drive(const int *levels);       /* RPWM, LPWM, R_EN, L_EN */
void bridge_wire(struct board_model *b, int number, const struct bridge_wiring *wiring);
void bridges_begin(struct board_model *b);
void bridges_restore(struct board_model *b);
void bridges_end(struct board_model *b, avr_cycle_count_t cycles);
void bridges_stand_still(struct board_model *b);

struct servo_wiring {
    char timer, channel;
    const char *pin;
};
int servo_wire(struct board_model *b, int number, const struct servo_wiring *wiring);    /* 0, or -1 */
void servos_begin(struct board_model *b);
void servos_restore(struct board_model *b);
void servos_end(struct board_model *b);
void servos_stand_still(struct board_model *b);

/* driver_line.c */
int driver_line_wire(struct board_model *b, char uart);     /* 0, or -1 */
void driver_line_begin(struct board_model *b);
void driver_line_end(struct board_model *b);

/* sonar.c */
void sonar_wire(struct board_model *b, int number, const char *trigger, const char *echo);
void sonars_arm(struct board_model *b);

/* twi.c */
int twi_wire(struct board_model *b);                    /* 0, or -1 */
void twi_restore(struct board_model *b);

/* uart.c */
avr_uart_t *uart_named(avr_t *avr, char name);          /* NULL: the processor has none */
avr_cycle_count_t uart_byte_cycles(avr_t *avr, const avr_uart_t *uart);
int uart_wire(struct board_model *b);                   /* 0, or -1 */
void uart_arm(struct board_model *b);
void uart_restore(struct board_model *b);

#endif
