#include <avr/sleep.h>
#include "firmware.h"

int main(void)
{
    firmware_setup();
    set_sleep_mode(SLEEP_MODE_IDLE);
    for (;;) {
        firmware_poll();
        /* An interrupt between the two is served, but what it left to do waits for the next one: at most the
         * clock's, within a millisecond. */
        sleep_mode();
    }
}
