/* A process on a computer runs the program, in simulated time: linux/process.c is its own code. */
#include "process.h"
#include "controller.h"
#include "machine.h"
#include "program.h"
#include "protocol.h"
#include "system.h"

void program_start(void)
{
    machine_board->process_stalls = PROCESS_RUNS;
    processor_lose_input();
    system_start();
    process_start(&protocol);
}

static int reset(int cause)
{
    system_line_write(protocol.stop, protocol.stop_bytes);
    return cause;
}

int program_turn(void)
{
    if (machine_board->process_stalls != PROCESS_RUNS)
        return 0;
    struct ending ending = process_turn();
    return ending.why ? reset(ending.cause) : 0;
}

/* A process that does not run at all hears nothing of its watchdog either. */
int program_on_watchdog(void)
{
    return machine_board->process_stalls == PROCESS_IS_SUSPENDED ? 0 : reset(RESET_WATCHDOG);
}
