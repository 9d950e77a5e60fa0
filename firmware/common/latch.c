#include <stdbool.h>
#include "hal.h"
#include "latch.h"

/* Two cells that say the same, written one after the other. When the power ends in a write, one cell may hold
 * anything, but the other is as it was or as it shall be: only both released, or both erased, are released. The
 * first boot writes what an erased EEPROM means, so that an erased cell is a torn one from then on. */
enum { CELLS = 2, ERASED = 0xff, RELEASED = 0x5a, LATCHED = 0xa0 /* + enum latch */ };

static uint8_t cause;
static uint8_t age_ms;
static uint8_t kept[CELLS];

static bool both_are(uint8_t value)
{
    return kept[0] == value && kept[1] == value;
}

static uint8_t cause_in(uint8_t cell)
{
    return cell > LATCHED && cell <= LATCHED + LATCH_RIGHT_OPPOSITE ? cell - LATCHED : LATCH_NONE;
}

void latch_start(void)
{
    for (uint8_t cell = 0; cell < CELLS; cell++)
        kept[cell] = hal_kept_latch(cell);
    cause = LATCH_NONE;
    if (both_are(ERASED) || both_are(RELEASED))
        return;
    for (uint8_t cell = 0; cell < CELLS && !cause; cell++)
        cause = cause_in(kept[cell]);
    if (!cause)
        cause = LATCH_ESTOP;    /* nobody knows any more */
}

void latch_engage(enum latch why)
{
    if (cause)
        return;
    cause = (uint8_t)why;
    age_ms = 0;
}

void latch_release(void)
{
    cause = LATCH_NONE;
}

enum latch latch_cause(void)
{
    return (enum latch)cause;
}

uint8_t latch_age_ms(void)
{
    return age_ms;
}

void latch_on_millisecond(void)
{
    if (age_ms < UINT8_MAX)
        age_ms++;
    uint8_t wanted = cause ? LATCHED + cause : RELEASED;
    uint8_t cell = kept[0] == wanted ? 1 : 0;
    if (kept[cell] == wanted || !hal_eeprom_is_ready())
        return;
    kept[cell] = wanted;
    hal_keep_latch(cell, wanted);
}
