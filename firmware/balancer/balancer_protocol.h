/* The wire of the balancing robot's board. A header beside protocol.h, so that the hash of that one stays as it is and
 * no other board has to be flashed. PROTOCOL_HASH of this board covers both headers. `generate_codec.py` makes
 * schemas/giraff_schemas/wires/balancer.py from it. `hello` and its request are protocol.h's.
 *
 * Forward, leaning forward and turning left are positive. Torques are those of both motors together, at the wheels.
 */
#ifndef GIRAFF_BALANCER_PROTOCOL_H
#define GIRAFF_BALANCER_PROTOCOL_H
#include "protocol.h"

enum balancer_frame_type {
    /* board to host */
    FRAME_BALANCE = 0x06,               /* 100 Hz */
    /* host to board */
    FRAME_BALANCE_CONFIGURE = 0x18,
    FRAME_BALANCE_DRIVE = 0x19,
    FRAME_BALANCE_ESTOP = 0x1a
};

enum {
    BALANCER_BOARD = 4,                 /* beside enum board_kind */
    BALANCER_BAUD = 500000,
    BALANCE_PERIOD_MS = 5,              /* of the control loop */
    BALANCE_REPORT_MS = 10,
    FREE_SIDE_MS = 400,                 /* a free side counts for so long after it was accepted */
    DRIVER_TIMEOUT_MS = 100,            /* the motor driver stops by itself without a packet for so long */
    DRIVER_BAUD = 38400,
    DRIVER_ADDRESS = 128,
    DRIVER_FULL = 127                   /* largest command of a motor */
};

enum balance_posture {
    BALANCE_OFF = 0,                    /* the motors have no power: it lies, or a person holds it */
    BALANCE_STANDS = 1,
    BALANCE_SITS_DOWN = 2               /* on its way from standing to off */
};

/* Why it is off or sits down: the first cause since it stood. */
enum balance_cause {
    CAUSE_NONE = 0,                     /* it has not stood since the boot */
    CAUSE_ASKED = 1,                    /* a drive frame asked it to sit */
    CAUSE_ESTOP_OFF = 2,
    CAUSE_CORD = 3,
    CAUSE_FALLEN = 4,                   /* beyond the angle that it can recover from */
    CAUSE_LIFTED = 5,                   /* the wheels turn freely */
    CAUSE_GYROSCOPE = 6,
    CAUSE_ACCELEROMETER = 7,
    CAUSE_LEFT_ENCODER = 8,
    CAUSE_RIGHT_ENCODER = 9,
    CAUSE_NO_WHEEL_TURNS = 10,          /* both encoders, or the line to the motor driver */
    CAUSE_BATTERY = 11,
    CAUSE_LEAN_DISPUTED = 12            /* accelerometer and filter disagree */
};

/* Latches of this board. Kept in EEPROM as those of protocol.h. */
enum balance_latch {
    BALANCE_LATCH_NONE = 0,
    BALANCE_LATCH_STANDS = 1,           /* engaged: it stands where it is, and does not drive or stand up */
    BALANCE_LATCH_OFF = 2               /* engaged as off: the motors have no power */
};

/* What an estop frame asks for. */
enum balance_engage { ENGAGE_RELEASE = 0, ENGAGE_STANDS = 1, ENGAGE_OFF = 2 };

/* What a drive frame asks of the posture. A robot that is off stands up only by ASK_STAND, only upright and still, and
 * only after an ASK_KEEP of a host that has been told that it is off. */
enum balance_ask { ASK_KEEP = 0, ASK_STAND = 1, ASK_SIT = 2 };

/* Where it may sit down. */
enum balance_side { SIDE_NONE = 0, SIDE_FORWARD = 1, SIDE_BACKWARD = 2 };

enum balance_flag {
    BALANCE_UPRIGHT = 1,                /* upright and still for long enough: it would stand if it were asked */
    BALANCE_HELD = 2,                   /* an obstacle held it; a zero drive frame ends that */
    BALANCE_AT_LIMIT = 4,               /* the torque is at its bound */
    BALANCE_CORD = 8                    /* the cord is pulled */
};

struct PACKED balance {
    uint8_t type;
    uint16_t seq;
    uint32_t board_us;                  /* begin of the newest control period */
    uint32_t board_ms;                  /* for the host to echo */
    uint32_t boot_id;
    uint32_t session;
    int32_t left_counts;                /* travel of each wheel on the floor in encoder counts: the lean is taken out */
    int32_t right_counts;
    int32_t lean_urad;                  /* filtered */
    int32_t rate_urad_s;
    int32_t accelerometer_urad;         /* lean by the accelerometer alone */
    int32_t trim_urad;                  /* lean at which it stands */
    int32_t speed_um_s;                 /* of the axle */
    int32_t turn_urad_s;
    int32_t torque_mnm;
    int8_t left_command;                /* to the motor driver, of DRIVER_FULL, forward positive */
    int8_t right_command;
    uint16_t battery_mv;
    uint16_t late;                      /* control periods that began late; wraps */
    uint8_t posture;                    /* enum balance_posture */
    uint8_t cause;                      /* enum balance_cause */
    uint8_t flags;                      /* enum balance_flag */
    uint8_t drive_state;                /* enum drive_state of protocol.h */
    uint8_t latch;                      /* enum balance_latch */
    uint8_t last_refusal;               /* enum refusal of protocol.h */
    uint16_t accepted;
    uint16_t refused;
    uint16_t line_errors;
};

/* k3 = k4 = 0: it balances by its lean alone, without encoders, as the prototype does. */
struct PACKED balance_configure {
    uint8_t type;
    uint16_t seq;
    uint32_t boot_id;
    uint32_t board_ms;
    uint32_t protocol_hash;
    uint32_t session;
    uint8_t wiring;                     /* enum wiring of protocol.h */
    uint32_t k1_mnm_rad;                /* gains of the four terms: torque for each rad, */
    uint32_t k2_mnm_s_rad;              /* rad/s, */
    uint32_t k3_mnm_m;                  /* m, */
    uint32_t k4_mnm_s_m;                /* m/s */
    uint32_t gravity_mnm_rad;           /* torque of gravity for each rad of lean: m g l */
    uint32_t momentum_gms;              /* momentum about the contact point for each m/s of speed, g m */
    uint32_t momentum_gm2;              /* and for each rad/s of lean, g m2 */
    uint32_t radius_um;                 /* of a wheel */
    uint32_t track_um;
    uint16_t counts_per_turn;           /* of an encoder for each turn of its wheel */
    uint16_t motor_mv_s;                /* back-EMF at the wheel for each rad/s, and N m for each A, in thousandths */
    uint16_t motor_mohm;
    uint16_t friction_mnm;              /* dry friction of one motor, at the wheel */
    uint32_t torque_max_mnm;
    uint16_t acceleration_mm_s2;
    uint16_t braking_mm_s2;
    uint16_t speed_max_mm_s;
    uint16_t turn_max_mrad_s;
    uint16_t battery_uv_count;          /* V of the battery for each ADC count, in millionths */
    uint16_t battery_min_mv;            /* below it the robot sits down */
    uint16_t driver_min_mv;             /* below it the motor driver cuts off */
};

struct PACKED balance_drive {
    uint8_t type;
    uint16_t seq;                       /* newer than the last one that was fresh, modulo 2^16 */
    uint32_t boot_id;
    uint32_t board_ms;                  /* newest one read from `balance` */
    int32_t linear_um_s;
    int32_t angular_urad_s;
    uint8_t ask;                        /* enum balance_ask */
    uint8_t free_side;                  /* enum balance_side */
};

/* As `estop` of protocol.h. An engaged latch becomes off when that is asked for; it never goes from off to stands. */
struct PACKED balance_estop {
    uint8_t type;
    uint16_t seq;
    uint32_t boot_id;
    uint32_t board_ms;
    uint32_t session;
    uint8_t engage;                     /* enum balance_engage; any value beyond it engages as off */
};

#endif
