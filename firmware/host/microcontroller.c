/* A microcontroller runs the program. Code takes no time. */
#include "firmware.h"
#include "program.h"
#include "protocol.h"

void program_start(void)
{
    firmware_setup();
    firmware_poll();
}

int program_turn(void)
{
    firmware_poll();
    return 0;
}

int program_on_watchdog(void)
{
    return RESET_WATCHDOG;
}
