/* What an echo line did since a ping, and what that means. Pure: no time or pin but those given. */
#ifndef GIRAFF_ECHO_H
#define GIRAFF_ECHO_H
#include <stdbool.h>
#include <stdint.h>
#include "protocol.h"

struct echo {
    bool rose, fell;            /* since the trigger; fell only after rose */
    uint32_t rose_us, fell_us;
};

struct verdict {
    enum { PENDING, KNOWN, NOT_BELIEVED } what;
    uint8_t state;              /* enum range_state, when KNOWN */
    uint8_t fault;              /* enum range_fault */
    uint32_t echo_us;
    bool next_is_doubtful;      /* the next ping may report a pulse of its own making */
};

/* high: the line, now. doubtful: next_is_doubtful of the verdict before. */
struct verdict echo_judge(const struct echo *echo, bool high, bool doubtful, uint32_t pinged_us, uint32_t now_us);

#endif
