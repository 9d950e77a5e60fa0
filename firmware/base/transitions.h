/* Each change on the two channels of one encoder, for the host that asks for it: transitions_protocol.h. */
#ifndef GIRAFF_TRANSITIONS_H
#define GIRAFF_TRANSITIONS_H
#include <stdbool.h>

void transitions_on_request(const void *body);
void transitions_poll(void);

/* From the interrupt at each change of the watched encoder, with the channels' levels just after it. A call without a
 * change is ignored. */
void transitions_on_change(bool a, bool b);

#endif
