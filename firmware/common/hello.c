#include "board.h"
#include "boot.h"
#include "clock.h"
#include "hello.h"
#include "link.h"
#include "protocol.h"

void hello_send(void)
{
    struct hello hello = {
        .type = FRAME_HELLO,
        .seq = link_next_seq(),
        .board_us = clock_us(),
        .board = BOARD_KIND,
        .protocol_hash = PROTOCOL_HASH,
        .boot_id = boot_id(),
        .reset_cause = boot_reset_cause(),
    };
    link_send(&hello, sizeof hello);
}

void hello_on_request(const void *body)
{
    (void)body;
    hello_send();
}
