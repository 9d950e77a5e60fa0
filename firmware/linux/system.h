/* What a board that is a process asks of its computer, beside hal.h: implemented by linux/ with the kernel, and by host/
 * in simulated time. */
#ifndef GIRAFF_SYSTEM_H
#define GIRAFF_SYSTEM_H
#include <stdint.h>

uint64_t system_ns(void);               /* since the process began; the time counts in which the computer sleeps */

/* To and from the motor controller. Nothing waits. */
void system_line_write(const uint8_t *bytes, uint8_t n);
uint8_t system_line_read(uint8_t *to, uint8_t room);

uint8_t system_port_read(uint8_t *to, uint8_t room);    /* from the host */

#endif
