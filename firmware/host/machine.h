/* Inside a host-compiled board: simulated time, and the parts soldered to the processor.
 *
 * Code takes no time here. Between two events the processor sleeps; each event is an interrupt, after which the
 * main loop is polled, as on the AVR. At one instant, events come in the order of `enum source`.
 */
#ifndef GIRAFF_MACHINE_H
#define GIRAFF_MACHINE_H
#include <stdint.h>
#include "board_model.h"

enum source { PART_0, PART_1, PART_2, PART_3, PART_4, WATCHDOG, CLOCK, UART_RX, UART_TX, SOURCES };

extern struct board_model *machine_board;       /* the only one of this library; NULL: none is open */

uint64_t machine_now_ns(void);
void machine_schedule(enum source source, uint64_t at_ns);      /* in place of what was scheduled for it */
void machine_cancel(enum source source);
int machine_is_scheduled(enum source source);
void machine_start(void);                       /* at time 0, with nothing scheduled */
enum source machine_next(uint64_t until_ns);    /* it is now the next event's instant; SOURCES: until_ns, without one */
void machine_complain(const char *message);     /* the firmware did what hardware would suffer from */

/* What the processor itself has: processor.c. */
void processor_open(void);
void processor_reset(int cause);
void processor_on_event(enum source source);
void processor_lose_input(void);                /* what the host has sent and the program has not got */

void system_start(void);                        /* of a process: system.c */

/* What is soldered to it: base_parts.c with bridges.c or servos.c, controller_parts.c, joystick_parts.c, ranger_parts.c. */
void parts_open(void);
void parts_reset(void);                         /* the processor's pins are inputs again */
void parts_begin(uint64_t until_ns);            /* of a slice */
void parts_end(void);
void parts_on_event(int part);

#endif
