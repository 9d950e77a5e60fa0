/* A process in the place of a board's processor. One thread runs all of the firmware: what interrupts do on a processor
 * comes between two polls. */
#ifndef GIRAFF_PROCESS_H
#define GIRAFF_PROCESS_H
#include <stdint.h>
#include "controller.h"

struct ending {
    uint8_t cause;                      /* of the reset: enum reset_cause */
    const char *why;                    /* NULL: the process goes on */
};

void process_start(const struct protocol *of_controller);
struct ending process_turn(void);       /* whenever something has come, and each millisecond */
uint64_t process_due_ns(void);          /* the next turn at the latest */

#endif
