/* What every board asks of its processor. Implemented by avr/ with registers and by host/ with simulated time;
 * what only one board has is in that board's own hal header.
 *
 * In the other direction, interrupts call what the modules' headers say is called from them.
 */
#ifndef GIRAFF_HAL_H
#define GIRAFF_HAL_H
#include <stdbool.h>
#include <stdint.h>

/* A statement that no interrupt splits. Simulated interrupts come between two polls, never inside one. */
#ifdef __AVR__
#include <util/atomic.h>
#define ATOMICALLY ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
#else
#define ATOMICALLY
#endif

enum { WATCHDOG_MS = 250 };

/* What is in EEPROM, from its first byte on; all ones where never written. */
struct kept {
    uint32_t boot_count;
    uint8_t latch[2];                       /* of the base board; latch.c knows what they mean */
};

uint8_t hal_take_reset_cause(void);         /* enum reset_cause; 0 = a boot loader has cleared it */
uint32_t hal_boot_count(void);
void hal_set_boot_count(uint32_t count);
uint8_t hal_kept_latch(uint8_t cell);
bool hal_eeprom_is_ready(void);             /* a write takes 3.4 ms; the next one only begins after it */
void hal_keep_latch(uint8_t cell, uint8_t value);   /* begins to write; only when it is ready */
void hal_start_watchdog(void);              /* resets the processor when not fed for WATCHDOG_MS */
void hal_feed_watchdog(void);
void hal_enable_interrupts(void);

void hal_start_clock(void);                 /* firmware_on_millisecond from now on, each millisecond */
uint16_t hal_clock_us(void);                /* since the last millisecond that was counted; interrupts off */
uint8_t hal_clock_counts(void);             /* the same in CLOCK_COUNTS_PER_MS of board.h, some more than one ms at most */

void hal_start_uart(void);
void hal_transmit(void);                    /* fetch bytes by uart_on_transmit until it has none */

#endif
