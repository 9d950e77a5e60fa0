/* Switches at the robot's rim, each closed to ground until something pushes it. */
#ifndef GIRAFF_BUMPERS_H
#define GIRAFF_BUMPERS_H

void bumpers_start(void);
void bumpers_on_request(const void *body);
void bumpers_poll(void);

#endif
