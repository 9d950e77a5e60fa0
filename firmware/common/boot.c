#include "boot.h"
#include "hal.h"

static uint32_t id;
static uint8_t cause;

void boot_start(void)
{
    cause = hal_take_reset_cause();
    uint32_t count = hal_boot_count();
    id = count == UINT32_MAX ? 1 : count + 1;       /* an erased EEPROM reads all ones */
    hal_set_boot_count(id);
}

uint32_t boot_id(void)
{
    return id;
}

uint8_t boot_reset_cause(void)
{
    return cause;
}
