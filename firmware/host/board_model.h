/* What a simulated board offers to the simulated world. Implemented twice, so that the world cannot tell:
 * by services/giraff_sim/lockstep (the real ELF on a simavr core) and by firmware/host (the same C compiled
 * for this machine). Read by cffi in ABI mode: lines that start with # are hidden from it.
 *
 * Time is simulated. The world moves the inputs, calls board_run to the end of the next slice (1 ms), and
 * reads the outputs.
 */
#ifndef GIRAFF_BOARD_MODEL_H
#define GIRAFF_BOARD_MODEL_H
#include <stdint.h>

enum { BOARD_MOTORS = 2, BOARD_SONARS = 3, BOARD_BUMPERS = 2, BOARD_SENSORS = 4 };
enum process_stalls { PROCESS_RUNS = 0, PROCESS_IS_SUSPENDED = 1, PROCESS_HANGS = 2 };
enum { BOARD_RUNNING = 0, BOARD_STOPPED = 1, BOARD_CRASHED = 2 };

/* The edges in one turn of an encoder's disk. */
struct encoder_disk {
    int edges, states;      /* how many, and the quadrature states by which the position grows in the turn */
    const double *at;       /* position of each within the turn, ascending from 0 */
    const uint8_t *levels;  /* just after each, turning forward: 1 for A, 2 for B, or both */
};

/* A motor with what drives it, by its number on the board, and the encoder of that number; boards/<board>/pins.h has
 * their pins. Forward is positive, as facts about the real board have it. */
struct motor_model {
    double position;        /* in: encoder position at the end of the next slice, in quadrature states (4x) */
    double drive;           /* out: mean of the signed duty over the last slice, -255..255, as the driver gives it */
    int drive_peak;         /* out: largest |duty| since the world last zeroed it: no pulse is too short to be seen */
    int encoder_cut;        /* in: 1 = the encoder's wires are cut, its pins stay as they are */
    int signal_cut;         /* in: 1 = the wire from a servo output to the motor driver is off; no other board has it */
    unsigned inputs_high;   /* in: these inputs of the motor driver are shorted to 5 V; bits in the order of base PWM, PHASE;
                             * of mega_l298n PWM, IN1, IN2; of mega_bts7960 RPWM, LPWM, R_EN, L_EN */
    unsigned inputs_low;    /* in: the wires of these are off, against pull-downs, or their half of the driver is dead */
    unsigned inputs_float;  /* in: these have no pull-down, and read high while the processor's pin is an input. The
                             * host's code, and other boards, have none of the three */
    double pulse_us;        /* out: width of the newest whole pulse at a servo output's pin; 0 = none yet */
    const struct encoder_disk *disk;    /* in: the disk that the encoder reads; NULL = ideal quadrature, an edge a state */
    int64_t states;         /* out: edges sent to the pins so far, forward positive */
};

struct board_model {
    struct motor_model motor[2];
    unsigned pings[3];      /* out: valid triggers seen, by sonar */
    uint8_t twi_register[256];  /* in/out: registers of the TWI slave; its behaviour is the world's */
    int twi_address;        /* in: 7 bits; 0 = nothing answers */
    uint64_t twi_reads;     /* out: bytes read */
    int slave_reset;        /* out: 1 while the board holds the slave's reset line low */
    int button;             /* in: 1 = pressed */
    int bumper_open[2];     /* in: 1 = the switch is open, or its wire is cut */
    double battery_volts;   /* in: at the ADC pin, 0..5 V */
    double limit_volts;     /* in: the same of the potentiometer that limits the level; 5 V where there is none */
    int driver_timeout_ms;  /* in: without pulses a motor driver in R/C mode is off then; 0 = never. 100 at first: an
                             * estimate, the maker publishes none */
    double sensor_volts[4]; /* in: at the ADC pins of analogue sensors, 0..3.3 V: on the balancer's board both axes of
                             * the gyroscope, then the accelerometer forward and up. No other board has them */
    double driver_volts;    /* in: at the terminals of a motor driver on a serial line */
    int driver_line_cut;    /* in: 1 = the serial line to it is off */
    int driver_line_held;   /* in: 1 = an adapter holds up what is sent to and fro, and gives it on later */
    int process_stalls;     /* in: enum process_stalls, of a board that is a process on a computer */
    int driver_wakes;       /* out: how often a byte has set its baud; in: 0 after its power was off */
    int driver_open;        /* out: 1 = its bridges are open and the motors turn freely; at duty 0 it brakes otherwise.
                             * On a Mega with an L298N or BTS7960: no enable wire is high. The host's code tells nothing of it */
    int cord_pulled;        /* in: 1 = the driver's emergency input is low, and the board's own pin tells so */
    unsigned tx_len;        /* out: bytes that board_uart_read would give */
    unsigned rx_free;       /* out: room for board_uart_write */
    uint64_t tx_total, rx_total, tx_lost;
    unsigned resets;        /* out: resets of every kind since board_open */
    unsigned errors;        /* out: the simulator's own complaints; the last one is in message */
    int state;              /* out: BOARD_RUNNING ... */
    double awake;           /* out: share of the last slice that the processor was awake; the host's code takes 0 */
    uint64_t now_us;        /* out: end of the last slice */
    /* Called when sonar k was triggered, at the exact instant its echo line would rise. Answers the echo pulse's
     * length in us; 0 = the line never rises, negative = it rises and stays high. NULL: every line stays low. */
    double (*on_ping)(void *user, int k);
    void *user;
    char message[160];
    struct board_private *inside;
};

/* image: the ELF to run; the host-compiled boards ignore it. board: its folder in firmware/boards.
 * NULL: cannot, and message (160 bytes) says why. */
struct board_model *board_open(const char *image, const char *board, char *message);
void board_close(struct board_model *b);
int board_run(struct board_model *b, uint64_t until_us);   /* the state */
int board_uart_read(struct board_model *b, uint8_t *to, int room);
int board_uart_write(struct board_model *b, const uint8_t *from, int n);   /* bytes taken */
/* cause: enum reset_cause of protocol.h; power-on also scrambles RAM. EEPROM is kept. */
void board_reset(struct board_model *b, int cause);
int board_eeprom(struct board_model *b, uint8_t *bytes, int n, int write);     /* 0, or -1 when it has none */
#endif
