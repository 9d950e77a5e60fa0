#include "encoders.h"
#include "hal.h"
#include "hal_balancer.h"

static volatile int16_t moved_by[2];
static uint8_t before;

void encoders_start(void)
{
    before = hal_encoder_pins();
    hal_start_encoders();
}

/* From both channels before, and both now, B above A: two that changed at once say nothing. */
static int8_t step(uint8_t from, uint8_t to)
{
    static const int8_t STEPS[16] = { 0, 1, -1, 0, -1, 0, 0, 1, 1, 0, 0, -1, 0, -1, 1, 0 };
    return STEPS[(from & 3) << 2 | (to & 3)];
}

void encoders_on_change(uint8_t pins)
{
    moved_by[0] += step(before, pins);
    moved_by[1] += step(before >> 2, pins >> 2);
    before = pins;
}

void encoders_take(int16_t moved[2])
{
    for (uint8_t k = 0; k < 2; k++) {
        ATOMICALLY {
            moved[k] = moved_by[k];
            moved_by[k] = 0;
        }
    }
}
