/* What every board asks of its processor. Implemented by avr/ with registers and by host/ with simulated time;
 * what only one board has is in that board's own hal header.
 *
 * In the other direction, interrupts call what the modules' headers say is called from them.
 */
#ifndef GIRAFF_HAL_H
#define GIRAFF_HAL_H
#include <stdbool.h>
#include <stdint.h>

/* A statement that no interrupt splits, on each processor by its own means. */
#if defined(__AVR__)
#include <util/atomic.h>
#define ATOMICALLY ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
#elif defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
static inline uint32_t atomically_begin(void)
{
    uint32_t primask;
    __asm__ volatile("mrs %0, primask\n\tcpsid i" : "=r"(primask) : : "memory");
    return primask;
}
static inline void atomically_end(const uint32_t *primask)
{
    __asm__ volatile("msr primask, %0" : : "r"(*primask) : "memory");
}
/* The clean-up restores the mask however the statement is left. */
#define ATOMICALLY \
    for (uint32_t primask_ __attribute__((cleanup(atomically_end))) = atomically_begin(), once_ = 1; once_; once_ = 0)
#elif defined(__unix__)
#define ATOMICALLY      /* a host's simulated interrupts come between two polls, never inside one */
#else
#error "hal.h does not know how this processor keeps interrupts out of a statement"
#endif

enum { WATCHDOG_MS = 250 };

/* What is in EEPROM, from its first byte on; all ones where never written. */
struct kept {
    uint32_t boot_count;
    uint8_t latch[2];                       /* of a board with motors; latch.c knows what they mean */
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
uint8_t hal_clock_stamps(void);             /* the same in CLOCK_STAMPS_PER_MS, some more than one ms at most */

void hal_start_uart(void);
void hal_transmit(void);                    /* fetch bytes by uart_on_transmit until it has none */

#endif
