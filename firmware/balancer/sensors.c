#include "hal.h"
#include "sensors.h"

enum { MOST = 60 };                 /* conversions whose sum fits 16 bits; after a late period the later ones are lost */

static struct sum {
    uint16_t counts;
    uint8_t n;
} sums[SENSORS];
static float last[SENSORS];         /* for a period without any */

void sensors_on_conversion(uint8_t sensor, uint16_t counts)
{
    struct sum *sum = &sums[sensor];
    if (sum->n >= MOST)
        return;
    sum->counts += counts;
    sum->n++;
}

void sensors_take(float means[SENSORS])
{
    struct sum taken[SENSORS];
    ATOMICALLY {
        for (uint8_t i = 0; i < SENSORS; i++) {
            taken[i] = sums[i];
            sums[i] = (struct sum){ 0 };
        }
    }
    uint8_t n = 0;
    float part = 0;                 /* 1 / n: most sensors have as many, and a division takes long */
    for (uint8_t i = 0; i < SENSORS; i++) {
        if (taken[i].n && taken[i].n != n) {
            n = taken[i].n;
            part = 1.0f / n;
        }
        if (taken[i].n)
            last[i] = (float)taken[i].counts * part;
        means[i] = last[i];
    }
}
