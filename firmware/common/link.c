#include "frame.h"
#include "hal.h"
#include "link.h"
#include "start_values.h"
#include "uart.h"

static struct frame_decoder decoder;
static uint16_t seq;

void link_start(void)
{
    seq = start_values.seq;
    hal_start_uart();
}

static void dispatch(const uint8_t *body, uint8_t size, const struct link_handler *handlers, uint8_t n)
{
    for (uint8_t i = 0; i < n; i++) {
        if (handlers[i].type == body[0] && handlers[i].size == size) {
            handlers[i].handle(body);
            return;
        }
    }
    decoder.errors++;
}

void link_poll(const struct link_handler *handlers, uint8_t n)
{
    int16_t byte;
    while ((byte = uart_receive()) >= 0) {
        uint8_t size = frame_decode(&decoder, (uint8_t)byte);
        if (size)
            dispatch(decoder.bytes, size, handlers, n);
    }
}

void link_send(const void *frame, uint8_t size)
{
    uint8_t line[FRAME_LINE_MAX];
    uart_send(line, frame_encode(frame, size, line));
}

bool link_has_room(uint8_t size, uint8_t another)
{
    enum { OVERHEAD = FRAME_LINE_MAX - FRAME_BODY_MAX };
    return size + another + 2 * OVERHEAD <= uart_room();
}

uint16_t link_next_seq(void)
{
    return seq++;
}

uint16_t link_errors(void)
{
    return (uint16_t)(decoder.errors + uart_lost());
}
