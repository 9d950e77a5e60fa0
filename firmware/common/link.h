/* Frames to and from the host. */
#ifndef GIRAFF_LINK_H
#define GIRAFF_LINK_H
#include <stdbool.h>
#include <stdint.h>

/* What a board does with one type of frame; `handle` gets a body of exactly `size` bytes. */
struct link_handler {
    uint8_t type;
    uint8_t size;
    void (*handle)(const void *body);
};

void link_start(void);

/* Handles the frames that have arrived; one with no handler counts as a line error. */
void link_poll(const struct link_handler *handlers, uint8_t n);

/* Sends a frame, or drops it when the line is full: its sequence number then shows the gap. */
void link_send(const void *frame, uint8_t size);

/* Whether the line would now take both a frame of `size` bytes and one of `another`. */
bool link_has_room(uint8_t size, uint8_t another);

uint16_t link_next_seq(void);
uint16_t link_errors(void);         /* as line_errors in protocol.h */

#endif
