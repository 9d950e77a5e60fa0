/* How a processor runs its program: microcontroller.c with ticking.c, or as a process on a computer process.c with system.c.
 */
#ifndef GIRAFF_PROGRAM_H
#define GIRAFF_PROGRAM_H
#include <stdint.h>

/* Causes are those of enum reset_cause; 0 = no reset. */
void program_start(void);               /* after a reset */
int program_turn(void);                 /* after each event */
int program_on_watchdog(void);          /* WATCHDOG */

void program_on_clock(void);            /* CLOCK */
void program_on_byte(uint8_t byte);     /* one has come from the host */

#endif
