/* USART 0, 8 data bits, no parity, 1 stop bit. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include "board.h"
#include "hal.h"
#include "uart.h"
#ifndef BAUD_TOL                    /* per cent: the baud is exact, or the board.h says why not */
#define BAUD_TOL 0
#endif
#include <util/setbaud.h>

#ifndef USART0_RX_vect              /* the ATmega328P has one USART and no number in its vectors' names */
#define USART0_RX_vect USART_RX_vect
#define USART0_UDRE_vect USART_UDRE_vect
#endif

ISR(USART0_RX_vect)
{
    uint8_t status = UCSR0A;        /* before UDR0: reading that takes the next byte's flags */
    uart_on_receive(UDR0, status & (_BV(FE0) | _BV(DOR0)));
}

ISR(USART0_UDRE_vect)
{
    int16_t byte = uart_on_transmit();
    if (byte < 0)
        UCSR0B &= (uint8_t)~_BV(UDRIE0);
    else
        UDR0 = (uint8_t)byte;
}

void hal_start_uart(void)
{
    UCSR0A = USE_2X ? _BV(U2X0) : 0;
    UBRR0H = UBRRH_VALUE;
    UBRR0L = UBRRL_VALUE;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);
}

void hal_transmit(void)
{
    ATOMICALLY {
        UCSR0B |= _BV(UDRIE0);
    }
}
