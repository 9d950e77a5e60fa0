/* What each board's program is: it is set up once after a reset, then polled after every interrupt. */
#ifndef GIRAFF_FIRMWARE_H
#define GIRAFF_FIRMWARE_H

void firmware_setup(void);
void firmware_poll(void);
void firmware_on_millisecond(void);     /* from the timer's interrupt */

#endif
