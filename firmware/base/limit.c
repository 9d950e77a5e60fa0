#include "hal_base.h"
#include "limit.h"

enum {
    STEP_MS = 4,                    /* in which the limit rises by a step: all of it within a second */
    FULL = 250                      /* of 255: few potentiometers come to their very end */
};

static volatile uint8_t allowed;    /* in force, of 255 */
static uint8_t rises_ms;

/* Down at once. Up it is a ramp while something drives, as base's is, which knows nothing of this. */
void limit_on_millisecond(bool drives)
{
    uint8_t set = hal_level_limit();
    if (set >= FULL)
        set = UINT8_MAX;
    if (set <= allowed || !drives) {
        allowed = set;
        rises_ms = 0;
    } else if (++rises_ms >= STEP_MS) {
        allowed++;
        rises_ms = 0;
    }
}

static int32_t magnitude(int32_t value)
{
    return value < 0 ? -value : value;
}

bool limit_lower(int32_t values[2], uint32_t most)
{
    int32_t left = (int32_t)(most * allowed / UINT8_MAX);
    int32_t first = magnitude(values[0]), second = magnitude(values[1]), largest = first > second ? first : second;
    if (largest <= left)
        return false;
    for (uint8_t wheel = 0; wheel < 2; wheel++)
        values[wheel] = (int32_t)((int64_t)values[wheel] * left / largest);
    return true;
}
