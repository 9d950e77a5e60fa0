/* The wire between a host and the three boards: the only declaration of it.
 *
 * A frame is COBS(body + CRC-16/CCITT-FALSE of body, low byte first) + 0x00; a body is one of the packed
 * little-endian structs below. `generate_codec.py` makes the Python codec from this file, and PROTOCOL_HASH
 * (the first 32 bits of the SHA-256 of its code, comments aside) travels in `hello` and `configure`: two
 * sides that disagree never drive.
 *
 * Units are in the names; where none is, the value is a count. Every frame starts with its type and a
 * sequence number of its sender; every frame of a board also carries the board's microseconds.
 */
#ifndef GIRAFF_PROTOCOL_H
#define GIRAFF_PROTOCOL_H
#include <stdint.h>

enum board_kind { BOARD_BASE = 1, BOARD_JOYSTICK = 2, BOARD_RANGER = 3 };

enum frame_type {
    /* board to host */
    FRAME_HELLO = 0x01,         /* at boot and on request */
    FRAME_WHEELS = 0x02,        /* base, 100 Hz */
    FRAME_TILT = 0x03,          /* joystick, 50 Hz */
    FRAME_RANGE = 0x04,         /* ranger, once a ping */
    /* host to board */
    FRAME_HELLO_REQUEST = 0x11, /* any board */
    FRAME_CONFIGURE = 0x12,     /* base */
    FRAME_DRIVE = 0x13,         /* base */
    FRAME_TICK = 0x14,          /* joystick, ranger */
    FRAME_ESTOP = 0x15,         /* base */
    FRAME_SPEED = 0x16          /* base */
};

/* Why the base board drives, or does not. */
enum drive_state {
    DRIVE_ACTIVE = 0,           /* accepted drive frames set the motors */
    DRIVE_NOT_CONFIGURED = 1,   /* no host has proved protocol and configuration since the boot */
    DRIVE_AWAITING_ZERO = 2,    /* configured; waits for a first zero drive frame */
    DRIVE_COMMAND_TIMEOUT = 3,  /* no accepted drive frame for COMMAND_TIMEOUT_MS; waits for a zero one */
    DRIVE_LATCHED = 4,          /* `latch` says why; waits for a release, then for a zero drive frame */
    DRIVE_HELD = 5              /* something held the wheel that `speed_flags` names; waits for a zero speed frame of a
                                 * host that has been told */
};

/* Bits of wheels.speed_flags: how the speed control gets on. */
enum speed_flag {
    SPEED_AT_LIMIT = 1,         /* a wheel cannot do what is asked; both are asked for less, so that the curve stays */
    SPEED_LEFT_OVERDUE = 2,     /* an edge is overdue: plain feed-forward */
    SPEED_RIGHT_OVERDUE = 4,
    SPEED_LEFT_HELD = 8,        /* why DRIVE_HELD, or the newest time that it was so */
    SPEED_RIGHT_HELD = 16
};

/* What holds the base board's motors at zero until an estop frame releases it. Kept in EEPROM, over every reset and
 * without power. The first cause stays until the release. */
enum latch {
    LATCH_NONE = 0,
    LATCH_ESTOP = 1,            /* a host engaged it */
    LATCH_LEFT_STUCK = 2,       /* |level| >= stall_level for STUCK_MS, and never STUCK_EDGES ticks away from where it
                                 * was; or held HELD_TIMES within HELD_WITHIN_MS */
    LATCH_RIGHT_STUCK = 3,
    LATCH_LEFT_OPPOSITE = 4,    /* turned against its level for OPPOSITE_MS and not ever slower: wired the other way */
    LATCH_RIGHT_OPPOSITE = 5
};

/* Why the base board refused the last drive, configure or release frame it refused. */
enum refusal {
    REFUSAL_NONE = 0,
    REFUSAL_PROTOCOL = 1,       /* another protocol hash, or values no robot can have */
    REFUSAL_BOOT_ID = 2,        /* made for an earlier boot of this board */
    REFUSAL_STALE = 3,          /* its board_ms is more than ECHO_MAX_AGE_MS ago, or ahead, or before the latch */
    REFUSAL_SEQUENCE = 4,       /* not newer than the last one that was fresh */
    REFUSAL_NOT_CONFIGURED = 5, /* no session; to a release, another one than it names */
    REFUSAL_AWAITING_ZERO = 6,  /* fresh, but the latch opens for a zero frame only */
    REFUSAL_LEVEL = 7,          /* a level or a speed beyond the configured maximum */
    REFUSAL_LATCHED = 8         /* fresh, but latched: nothing drives before a release */
};

/* State of the BNO055, as the joystick board knows it. */
enum tilt_status {
    TILT_RUNNING = 0,
    TILT_STARTING = 1,          /* in reset, or in the datasheet's start-up and mode-change waits */
    TILT_BUS_FAULT = 2,         /* no answer, a short read, or an all-zero vector: gravity is never zero */
    TILT_WRONG_CHIP = 3,        /* CHIP_ID or ACC_ID is not a BNO055's */
    TILT_SELF_TEST_FAILED = 4,
    TILT_SYSTEM_ERROR = 5       /* SYS_STATUS is not "running without fusion"; sys_error says why */
};

enum range_state { RANGE_ECHO = 0, RANGE_CLEAR = 1, RANGE_FAULT = 2 };

enum range_fault {
    RANGE_FAULT_NONE = 0,
    RANGE_FAULT_NO_ECHO_PULSE = 1,  /* the echo line never rose: sensor dead or unpowered, trigger wire off */
    RANGE_FAULT_STUCK_HIGH = 2,     /* the echo line stays high, longer than any sensor waits: echo wire off */
    RANGE_FAULT_TOO_SHORT = 3       /* a pulse shorter than any distance the sensor can measure */
};

/* Bits of configure.wiring: how motors and encoders are soldered to what the wire calls left and right. */
enum wiring {
    WIRING_SWAP_MOTORS = 1,         /* else left is motor A (PD6, PC6) */
    WIRING_SWAP_ENCODERS = 2,       /* else left is the encoder on PD3 and PC7 */
    WIRING_INVERT_LEFT_MOTOR = 4,
    WIRING_INVERT_RIGHT_MOTOR = 8,
    WIRING_INVERT_LEFT_ENCODER = 16,
    WIRING_INVERT_RIGHT_ENCODER = 32
};

/* Bits of hello.reset_cause, the same on all three processors (MCUSR). */
enum reset_cause { RESET_POWER_ON = 1, RESET_EXTERNAL = 2, RESET_BROWN_OUT = 4, RESET_WATCHDOG = 8 };

enum {
    BASE_BAUD = 115200,
    JOYSTICK_BAUD = 500000,
    RANGER_BAUD = 500000,
    COMMAND_TIMEOUT_MS = 300,
    ECHO_MAX_AGE_MS = 150,
    STUCK_MS = 500,
    STUCK_EDGES = 10,
    OPPOSITE_MS = 200,
    SPEED_PERIOD_MS = 10,           /* of the speed control */
    STAMPS_PER_MS = 72,             /* of the base board's clock: how fine it tells an edge's time */
    OVERDUE_INTERVALS = 3,          /* an edge is overdue after so many of the newest interval, */
    OVERDUE_MS = 30,                /* and not before */
    SILENT_MS = 200,                /* without an edge, asked for HELD_FROM_UM_S or more: held */
    HELD_FROM_UM_S = 100000,        /* slower wheels are not judged to be held */
    HELD_REACH_MS = 600,            /* asked for HELD_FROM_UM_S or more, at less than half of what is asked: held */
    HELD_FALLEN_MS = 30,            /* at less than half of the speed it had: held */
    HELD_TIMES = 3,                 /* within HELD_WITHIN_MS: latched as stuck */
    HELD_WITHIN_MS = 60000,
    PWM_OVER_PERCENT = 30,          /* above feed-forward and dead zone at most, */
    PWM_OVER_BLIND_PERCENT = 50,    /* where the battery's voltage is unknown */
    WHEELS_PERIOD_MS = 10,
    TILT_PERIOD_MS = 20,
    RANGE_SLOT_MS = 60,             /* between two pings, of whichever sensor: echoes have died down by then */
    RANGE_SENSORS = 3,
    TILT_LSB_PER_M_S2 = 100,        /* BNO055 datasheet 3.6.4.1 */
    ECHO_US_PER_M = 5800            /* HC-SR04 datasheet: 58 us a centimetre, there and back */
};

#define PACKED __attribute__((packed))

struct PACKED hello {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;
    uint8_t board;                  /* enum board_kind */
    uint32_t protocol_hash;
    uint32_t boot_id;               /* counts boots, kept in EEPROM: never 0 */
    uint8_t reset_cause;            /* enum reset_cause */
};

struct PACKED wheels {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;              /* when the ticks were read; wraps after 71 minutes */
    uint32_t board_ms;              /* for the host to echo; wraps after 49 days */
    uint32_t boot_id;
    uint32_t session;               /* of the configure frame in force; 0 = none */
    int32_t left_ticks;             /* forward positive; both edges of channel A; wraps */
    int32_t right_ticks;
    int16_t left_pwm_counts;        /* what the motor gets now, of 255, forward positive */
    int16_t right_pwm_counts;
    uint8_t drive_state;            /* enum drive_state */
    uint8_t latch;                  /* enum latch */
    uint8_t last_refusal;           /* enum refusal */
    uint16_t accepted;              /* drive frames accepted since the boot; wraps */
    uint16_t refused;               /* drive, configure and release frames refused since the boot; wraps */
    uint16_t line_errors;           /* frames with a wrong CRC or shape, bytes lost; wraps */
    uint16_t battery_adc_counts;    /* 10 bit, of AVCC */
    int32_t left_um_s;              /* speed, from the edges and the time between them; forward positive */
    int32_t right_um_s;
    uint8_t speed_flags;            /* enum speed_flag */
};

struct PACKED tilt {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;
    uint32_t boot_id;
    uint32_t tick_epoch;            /* newest tick held when the reading began; epoch 0 = none yet */
    uint64_t tick_robot_ns;
    int16_t x;                      /* TILT_LSB_PER_M_S2 */
    int16_t y;
    int16_t z;
    uint8_t status;                 /* enum tilt_status */
    uint8_t sys_status;             /* BNO055 registers SYS_STATUS and SYS_ERR, as read */
    uint8_t sys_error;
    uint8_t button;                 /* 1 = pressed */
    uint16_t line_errors;
};

struct PACKED range {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;              /* of the trigger */
    uint32_t boot_id;
    uint32_t tick_epoch;            /* newest tick held at the trigger; epoch 0 = none yet */
    uint64_t tick_robot_ns;
    uint8_t sensor;                 /* 0 .. RANGE_SENSORS-1 */
    uint8_t state;                  /* enum range_state */
    uint8_t fault;                  /* enum range_fault */
    uint32_t echo_us;               /* 0 = none measured */
    uint16_t line_errors;
};

struct PACKED hello_request {
    uint8_t type;
    uint16_t seq;
};

/* Opens a session: motors to zero, any earlier sequence number forgotten, then a zero drive frame is awaited. */
struct PACKED configure {
    uint8_t type;
    uint16_t seq;
    uint32_t protocol_hash;
    uint32_t boot_id;
    uint32_t board_ms;              /* newest one read from `wheels` */
    uint32_t session;               /* random, not 0 */
    uint8_t wiring;                 /* enum wiring */
    uint8_t level_max;              /* largest |level| a drive frame may ask for; 0 = only zero: speeds are asked for */
    uint8_t stall_level;            /* |level| from which a wheel that stands still is stuck, 1..255 */
    uint32_t left_counts_per_km;    /* of left_ticks, in 1000 m of its rim's way; 0 = not known: no speeds at all */
    uint32_t right_counts_per_km;
    uint32_t speed_max_um_s;        /* largest |speed| a speed frame may ask of a wheel; 0 = only zero: levels */
    uint32_t acceleration_um_s2;    /* of a wheel's increases only */
    uint32_t nominal_um_s;          /* speed of a wheel that turns freely at nominal_level, */
    uint8_t nominal_level;          /* 1..255, */
    uint16_t nominal_adc_counts;    /* and such a battery; 0 = its divider is not known */
    uint16_t motor_ms;              /* time constant of a motor with its share of the robot */
    uint8_t pwm_max;                /* most PWM counts that the speed control gives a wheel, 1..255 */
    uint8_t stall_pwm;              /* most that it gives one that stands, or has an edge overdue */
    uint8_t dead_pwm;               /* feed-forward's least for one that is to turn: less only makes it hum */
    uint16_t speed_p;               /* gains of each wheel's loop: PWM counts for each m/s, */
    uint16_t speed_i;               /* and for each m */
    uint16_t turn_p;                /* of the loop that couples them, by right minus left */
    uint16_t turn_i;
};

struct PACKED drive {
    uint8_t type;
    uint16_t seq;                   /* newer than the last one that was fresh, modulo 2^16 */
    uint32_t boot_id;
    uint32_t board_ms;              /* newest one read from `wheels` */
    int16_t left_level;             /* PWM counts of 255, forward positive */
    int16_t right_level;
};

/* The same in speeds, which the board's own loops hold. */
struct PACKED speed {
    uint8_t type;
    uint16_t seq;                   /* one count with `drive` */
    uint32_t boot_id;
    uint32_t board_ms;              /* newest one read from `wheels` */
    int32_t left_um_s;              /* forward positive */
    int32_t right_um_s;
};

/* Latches or releases. Latching is obeyed whatever boot, time and session it names: an old one can only stop. A
 * release must be of this boot and session, as fresh as a drive frame, and made after the latch was told of; it
 * permits motion and never causes it: DRIVE_AWAITING_ZERO follows. */
struct PACKED estop {
    uint8_t type;
    uint16_t seq;
    uint32_t boot_id;
    uint32_t board_ms;              /* newest one read from `wheels` */
    uint32_t session;
    uint8_t engage;                 /* 0 = release whatever is latched, any other value = latch as LATCH_ESTOP */
};

/* A moment of the robot's clock, sent down so that a measurement can carry the one it was made after. */
struct PACKED tick {
    uint8_t type;
    uint16_t seq;
    uint32_t epoch;                 /* not 0 */
    uint64_t robot_ns;
};

#endif
