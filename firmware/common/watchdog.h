/* The hardware watchdog: resets the board when its main loop or its clock has stopped. */
#ifndef GIRAFF_WATCHDOG_H
#define GIRAFF_WATCHDOG_H

void watchdog_start(void);
void watchdog_poll(void);       /* from the main loop only */

#endif
