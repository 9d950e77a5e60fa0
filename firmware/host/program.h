/* How a processor runs its program: ticking.c as a microcontroller does, process.c as a process on a computer. */
#ifndef GIRAFF_PROGRAM_H
#define GIRAFF_PROGRAM_H
#include <stdint.h>

void program_start(void);               /* after a reset */
void program_on_clock(void);            /* CLOCK */
void program_on_watchdog(void);         /* WATCHDOG */
void program_on_byte(uint8_t byte);     /* one has come from the host */
void program_after_event(void);

#endif
