/* EEPROM that takes 4 ms for a byte, as the AVR's does, and counts what is written of the latch in the ranger's
 * pings, which a base board has none of. */
#include "hal.h"
#include "machine.h"

enum { WRITE_NS = 4000000 };

void __real_hal_keep_latch(uint8_t cell, uint8_t value);
void __wrap_hal_keep_latch(uint8_t cell, uint8_t value);
bool __wrap_hal_eeprom_is_ready(void);

static uint64_t ready_ns;

bool __wrap_hal_eeprom_is_ready(void)
{
    return machine_now_ns() >= ready_ns;
}

void __wrap_hal_keep_latch(uint8_t cell, uint8_t value)
{
    if (!__wrap_hal_eeprom_is_ready())
        machine_complain("EEPROM written before it was ready");
    ready_ns = machine_now_ns() + WRITE_NS;
    machine_board->pings[0]++;
    __real_hal_keep_latch(cell, value);
}
