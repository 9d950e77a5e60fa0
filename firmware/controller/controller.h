/* A motor controller that others have made, on a serial line, in the place of a base board's motors, encoders and battery.
 * controller.c asks one request after the other and judges silence; a file for each protocol has its bytes.
 */
#ifndef GIRAFF_CONTROLLER_H
#define GIRAFF_CONTROLLER_H
#include <stdbool.h>
#include <stdint.h>

enum { CONTROLLER_FULL = 32767, CONTROLLER_MOTORS = 2, CONTROLLER_REQUEST_MAX = 32, CONTROLLER_STOP_MAX = 20 };

struct protocol;

/* For the processor. Times are its milliseconds, which may begin anywhere. */
void controller_start(const struct protocol *of_controller, uint32_t now_ms);        /* what is sent first is its stop */
bool controller_is_proved(void);                /* it has said what it is, and keeps the time-out that it was given */
void controller_begin(uint32_t now_ms);         /* what it was proved to be it must have said again within its times from now on */
void controller_on_byte(uint8_t byte, uint32_t now_ms);
void controller_turn(uint32_t now_ms);          /* may send the next request */

/* It has not answered, or not as it has proved to be: the board must be reset. NULL: all is well. */
const char *controller_lost(void);
bool controller_answers(void);                  /* while it is not proved: something comes, if not what it should */

/* For the protocols. */
enum heard {
    HEARD_PART,
    HEARD_ALL,
    HEARD_KEPT,                                 /* all, and it says its time-out, which is as it was set */
    HEARD_NOISE,                                /* no reply of this protocol */
    HEARD_OTHERWISE                             /* a whole reply, of a controller that is not as it must be */
};

enum step { STEP_PROVE, STEP_COMMAND, STEP_COUNTERS, STEP_OTHER };

struct protocol {
    uint32_t baud;
    const char *expects;                        /* what must be true of the controller, for who looks for its silence */
    uint8_t cycle_ms;                           /* a command and a reading, no faster */
    uint8_t other_ms;                           /* one of the other things is asked, no faster */
    uint8_t reply_ms;                           /* a reply that is later is missing */
    uint8_t quiet_ms;                           /* silence after which half a request is forgotten */
    uint8_t lost_ms;                            /* without any reply: it is lost */
    uint8_t kept_ms;                            /* without HEARD_KEPT: it is lost. 0 = its time-out cannot be read */
    uint32_t leap;                              /* counts that no wheel turns between two readings: its counters began anew */
    uint8_t proofs, others;                     /* how many requests prove it; how many other things are asked in turn */
    uint8_t stop_bytes, stop[CONTROLLER_STOP_MAX];      /* stops it at once, whatever was under way */

    /* Make a request; its length. duty: of CONTROLLER_FULL, for a command. number: of the proof, or of the other thing. */
    uint8_t (*ask)(uint8_t *to, enum step step, uint8_t number, const int16_t duty[CONTROLLER_MOTORS]);
    enum heard (*hear)(uint8_t byte);           /* a byte of the reply to the newest request */
};
extern const struct protocol protocol;          /* of the board's controller */

/* From a protocol, as it hears them. Counters wrap. */
void controller_tell_counters(const uint32_t counters[CONTROLLER_MOTORS]);
void controller_tell_battery(uint16_t tenths);  /* of a volt */
void controller_tell_stop(void);                /* its own emergency input is pressed */

#endif
