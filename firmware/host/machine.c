#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware.h"
#include "machine.h"
#include "protocol.h"
#include "servo_driver.h"

#define EXPORT __attribute__((visibility("default")))

enum { MESSAGE_SIZE = sizeof ((struct board_model *)0)->message };

struct board_model *machine_board;
uint8_t machine_eeprom[EEPROM_SIZE];
int machine_reset_cause;

static uint64_t now_ns;
static uint64_t due_ns[SOURCES];
static const uint64_t NEVER = UINT64_MAX;

uint64_t machine_now_ns(void)
{
    return now_ns;
}

void machine_schedule(enum source source, uint64_t at_ns)
{
    due_ns[source] = at_ns;
}

void machine_cancel(enum source source)
{
    due_ns[source] = NEVER;
}

int machine_is_scheduled(enum source source)
{
    return due_ns[source] != NEVER;
}

void machine_complain(const char *message)
{
    machine_board->errors++;
    snprintf(machine_board->message, MESSAGE_SIZE, "%s", message);
}

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
    machine_reset_cause = cause;
    initialise_variables();
    processor_reset();
    parts_reset();
    firmware_setup();
    firmware_poll();
}

static enum source next_source(void)
{
    enum source next = PART_0;
    for (enum source source = PART_0; source < SOURCES; source++)
        if (due_ns[source] < due_ns[next])
            next = source;
    return next;
}

static void fire(enum source source)
{
    machine_cancel(source);
    if (source == WATCHDOG) {
        board_reset(machine_board, RESET_WATCHDOG);
        return;
    }
    if (source < WATCHDOG)
        parts_on_event(source);
    else
        processor_on_event(source);
    firmware_poll();
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
    memset(machine_eeprom, 0xFF, sizeof machine_eeprom);        /* as delivered: erased */
    now_ns = 0;
    for (enum source source = PART_0; source < SOURCES; source++)
        machine_cancel(source);
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
    if (until_ns <= now_ns)
        return b->state;
    parts_begin(until_ns);
    for (enum source next = next_source(); due_ns[next] <= until_ns; next = next_source()) {
        now_ns = due_ns[next];
        fire(next);
    }
    now_ns = until_ns;
    parts_end();
    b->now_us = until_us;
    return b->state;
}

EXPORT void board_reset(struct board_model *b, int cause)
{
    b->resets++;
    reset(cause);
}

EXPORT int board_eeprom(struct board_model *b, uint8_t *bytes, int n, int write)
{
    (void)b;
    if (n < 0 || n > EEPROM_SIZE)
        return -1;
    if (write)
        memcpy(machine_eeprom, bytes, (size_t)n);
    else
        memcpy(bytes, machine_eeprom, (size_t)n);
    return 0;
}
