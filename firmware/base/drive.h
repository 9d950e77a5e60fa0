/* Who may drive the motors, with what, and for how long. Only policy: time and identity come in as arguments. */
#ifndef GIRAFF_DRIVE_H
#define GIRAFF_DRIVE_H
#include <stdint.h>
#include "encoders.h"
#include "protocol.h"
#include "wiring.h"

struct drive_report {       /* fields of `wheels` */
    uint32_t session;
    uint8_t drive_state;
    uint8_t latch;
    uint8_t last_refusal;
    uint16_t accepted;
    uint16_t refused;
    int32_t um_s[2];        /* by wheel */
    uint8_t speed_flags;
};

void drive_start(void);
void drive_on_configure(const struct configure *asked, uint32_t boot_id, uint32_t now_ms);
void drive_on_levels(const struct drive *asked, uint32_t boot_id, uint32_t now_ms);
void drive_on_speeds(const struct speed *asked, uint32_t boot_id, uint32_t now_ms);
void drive_on_estop(const struct estop *asked, uint32_t boot_id, uint32_t now_ms);
struct drive_report drive_report(void);
uint8_t drive_wiring(void);
void drive_on_battery(uint16_t adc_counts);

/* From the millisecond interrupt, so that neither a busy line nor a main loop that hangs delays a stop.
 * newest: by encoder. now_stamp: clock_stamp(). */
void drive_on_millisecond(const struct encoders_edge newest[2], uint16_t now_stamp);
int16_t drive_level(uint8_t motor);         /* what the motor shall get now */

#endif
