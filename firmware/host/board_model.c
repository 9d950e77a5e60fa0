/* A host-compiled board: its program, its processor and its parts, through events in their order. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "machine.h"
#include "program.h"
#include "protocol.h"
#include "servo_driver.h"

#define EXPORT __attribute__((visibility("default")))

enum { MESSAGE_SIZE = sizeof ((struct board_model *)0)->message };

/* What start-up code does on the AVR: the program's variables as they were linked. firmware.ld has them in one
 * place. A sanitizer's red zones lie between them, so this is byte by byte and not checked. */
extern char firmware_variables[], firmware_variables_end[];
static char *initial;

__attribute__((no_sanitize("address"))) static void copy_unchecked(char *to, const char *from, size_t n)
{
    for (volatile size_t i = 0; i < n; i++)
        to[i] = from[i];
}

static void initialise_variables(void)
{
    /* cppcheck-suppress comparePointers ; both are the linker's, of one section */
    size_t n = (size_t)(firmware_variables_end - firmware_variables);
    if (initial) {
        copy_unchecked(firmware_variables, initial, n);
    } else {
        initial = malloc(n);
        copy_unchecked(initial, firmware_variables, n);
    }
}

static void reset(int cause)
{
    initialise_variables();
    processor_reset(cause);
    parts_reset();
    program_start();
}

static void end(int cause)
{
    if (cause)
        board_reset(machine_board, cause);
}

static void fire(enum source source)
{
    if (source == WATCHDOG) {
        end(program_on_watchdog());
        return;
    }
    if (source < WATCHDOG)
        parts_on_event(source);
    else
        processor_on_event(source);
    end(program_turn());
}

EXPORT struct board_model *board_open(const char *image, const char *board, char *message)
{
    (void)image;
    if (strcmp(board, BOARD)) {
        snprintf(message, MESSAGE_SIZE, "this library is the board %s, not %s", BOARD, board);
        return NULL;
    }
    if (machine_board) {
        snprintf(message, MESSAGE_SIZE, "this library's one board is open; load a copy of the library for another");
        return NULL;
    }
    machine_board = calloc(1, sizeof *machine_board);
    machine_board->limit_volts = 5;
    machine_board->driver_timeout_ms = SERVO_TIMEOUT_MS;
    machine_start();
    processor_open();
    parts_open();
    reset(RESET_POWER_ON);
    return machine_board;
}

EXPORT void board_close(struct board_model *b)
{
    if (!b)
        return;
    free(b);
    machine_board = NULL;
}

EXPORT int board_run(struct board_model *b, uint64_t until_us)
{
    uint64_t until_ns = until_us * 1000;
    if (until_ns <= machine_now_ns())
        return b->state;
    parts_begin(until_ns);
    for (enum source next = machine_next(until_ns); next < SOURCES; next = machine_next(until_ns))
        fire(next);
    parts_end();
    b->now_us = until_us;
    return b->state;
}

EXPORT void board_reset(struct board_model *b, int cause)
{
    b->resets++;
    reset(cause);
}
