#include <stdio.h>
#include "machine.h"

struct board_model *machine_board;

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

void machine_start(void)
{
    now_ns = 0;
    for (enum source source = PART_0; source < SOURCES; source++)
        machine_cancel(source);
}

enum source machine_next(uint64_t until_ns)
{
    enum source next = PART_0;
    for (enum source source = PART_0; source < SOURCES; source++)
        if (due_ns[source] < due_ns[next])
            next = source;
    if (due_ns[next] > until_ns) {
        now_ns = until_ns;
        return SOURCES;
    }
    now_ns = due_ns[next];
    machine_cancel(next);
    return next;
}

void machine_complain(const char *message)
{
    machine_board->errors++;
    snprintf(machine_board->message, sizeof machine_board->message, "%s", message);
}
