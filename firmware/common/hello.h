/* The frame by which a host knows which board, which protocol and which boot it talks to. */
#ifndef GIRAFF_HELLO_H
#define GIRAFF_HELLO_H

void hello_send(void);
void hello_on_request(const void *body);

#endif
