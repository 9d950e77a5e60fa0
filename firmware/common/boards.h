/* Boards on which the program of another board runs, too. `board` of `hello` tells them apart, so that a host never
 * takes one for another. Their numbers are beside those of enum board_kind, and of the balancer's board, which is 4.
 * This is no part of protocol.h, so that its hash stays as it is. `generate_codec.py` makes
 * schemas/giraff_schemas/wires/boards.py from it.
 */
#ifndef GIRAFF_BOARDS_H
#define GIRAFF_BOARDS_H

enum {
    ARDROS_BOARD = 5,
    MEGA_L298N_BOARD = 6,
    MEGA_BTS7960_BOARD = 7,
    NANO_RANGER_BOARD = 8,
    ROBOCLAW_BOARD = 9,
    ROS_ARDUINO_BRIDGE_BOARD = 10
};

/* So long after the newest byte a motor controller that others have made stops by itself. */
enum {
    ROBOCLAW_STOPS_AFTER_MS = 200,              /* set, and read back while it drives: TIMEOUT_TENTHS of roboclaw.c */
    ROS_ARDUINO_BRIDGE_STOPS_AFTER_MS = 2000    /* fixed: AUTO_STOP_INTERVAL of its own source */
};

#endif
