/* Who may drive the motors, with what, and for how long. Only policy: time and identity come in as arguments. */
#ifndef GIRAFF_DRIVE_H
#define GIRAFF_DRIVE_H
#include <stdint.h>
#include "protocol.h"
#include "wiring.h"

struct drive_report {       /* fields of `wheels` */
    uint32_t session;
    uint8_t drive_state;
    uint8_t latch;
    uint8_t last_refusal;
    uint16_t accepted;
    uint16_t refused;
};

void drive_start(void);
void drive_on_configure(const struct configure *asked, uint32_t boot_id, uint32_t now_ms);
void drive_on_command(const struct drive *asked, uint32_t boot_id, uint32_t now_ms);
void drive_on_estop(const struct estop *asked, uint32_t boot_id, uint32_t now_ms);
struct drive_report drive_report(void);
uint8_t drive_wiring(void);

/* From the millisecond interrupt, so that neither a busy line nor a main loop that hangs delays a stop.
 * ticks: the low halves of both encoders' counts. */
void drive_on_millisecond(const uint16_t ticks[2]);
int16_t drive_level(uint8_t motor);         /* what the motor shall get now */

#endif
