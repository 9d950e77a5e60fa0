/* Reset, watchdog, EEPROM: alike on the three processors. */
#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>
#include "hal.h"

/* The ELF file holds this, too, for who writes it: as erased. */
static struct kept kept EEMEM = { .boot_count = UINT32_MAX, .latch = { UINT8_MAX, UINT8_MAX } };

uint8_t hal_take_reset_cause(void)
{
    uint8_t cause = MCUSR;
    MCUSR = 0;          /* WDRF keeps the watchdog on, at its shortest, until it is cleared */
    wdt_disable();
    return cause;
}

uint32_t hal_boot_count(void)
{
    return eeprom_read_dword(&kept.boot_count);
}

void hal_set_boot_count(uint32_t count)
{
    eeprom_update_dword(&kept.boot_count, count);
    eeprom_busy_wait();
}

uint8_t hal_kept_latch(uint8_t cell)
{
    return eeprom_read_byte(&kept.latch[cell]);
}

bool hal_eeprom_is_ready(void)
{
    return eeprom_is_ready();
}

void hal_keep_latch(uint8_t cell, uint8_t value)
{
    eeprom_write_byte(&kept.latch[cell], value);    /* would wait for a write before it, not for its own */
}

void hal_start_watchdog(void)
{
    _Static_assert(WATCHDOG_MS == 250, "WDTO_250MS is what is set");
    wdt_enable(WDTO_250MS);
}

void hal_feed_watchdog(void)
{
    wdt_reset();
}

void hal_enable_interrupts(void)
{
    sei();
}
