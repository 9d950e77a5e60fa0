/* A board that is a process of Linux: main.c is the process, and each other file has a part of what hal.h and system.h
 * ask for. */
#ifndef GIRAFF_LINUX_H
#define GIRAFF_LINUX_H
#include <stdint.h>

/* As the first. let_go stops the motors and takes the port away, whenever the process ends or begins anew. */
void linux_begin(char **words, void (*let_go)(void));

/* On stderr, after the board's name. */
void linux_say(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Only a person can mend it. The motors are stopped, and the process ends. */
_Noreturn void linux_fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* As the reset of a board: the motors are stopped, and the program begins anew. For handlers of signals, too. */
_Noreturn void linux_reset(uint8_t cause, const char *why);

void eeprom_open(const char *path);

struct protocol;
void line_open(const char *path, const struct protocol *of_controller);        /* waits until the serial port is there */
int line_descriptor(void);              /* -1 = not open */
void line_stop(void);                   /* stops the motors. For handlers of signals, too */

void port_choose(const char *path);     /* where the host finds the board once it has started */
int port_descriptor(void);              /* -1 = it has not started */
void port_remove(void);                 /* For handlers of signals, too */

#endif
