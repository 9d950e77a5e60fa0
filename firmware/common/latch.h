/* What holds the motors at zero until a host releases it. Kept in EEPROM, over every reset and without power.
 * Interrupts off for all of it but latch_start: both the main loop and the millisecond interrupt latch. */
#ifndef GIRAFF_LATCH_H
#define GIRAFF_LATCH_H
#include <stdint.h>
#include "protocol.h"

void latch_start(void);
void latch_engage(enum latch cause);    /* the first cause stays until the release */
void latch_release(void);
enum latch latch_cause(void);           /* LATCH_NONE: nothing is latched */
uint8_t latch_age_ms(void);             /* since it was latched, or since the boot that found it so; 255 = longer */

void latch_on_millisecond(void);        /* keeps what has changed, without waiting for EEPROM */

#endif
