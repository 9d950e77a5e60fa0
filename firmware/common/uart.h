/* The serial line, as two rings that interrupts empty and fill. */
#ifndef GIRAFF_UART_H
#define GIRAFF_UART_H
#include <stdbool.h>
#include <stdint.h>

bool uart_send(const uint8_t *bytes, uint8_t n);    /* all of them, or none and false when there is no room */
uint8_t uart_room(void);                            /* bytes that it would take now */
int16_t uart_receive(void);                         /* the next byte, or -1 */
uint16_t uart_lost(void);                           /* bytes that came damaged or found no room; wraps */

/* From the interrupts. */
void uart_on_receive(uint8_t byte, bool damaged);
int16_t uart_on_transmit(void);                     /* the next byte to go out, or -1 */

#endif
