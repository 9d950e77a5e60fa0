/* The BNO055 as an accelerometer: brought up as its datasheet asks, read, and brought up again after faults. */
#ifndef GIRAFF_BNO055_H
#define GIRAFF_BNO055_H
#include <stdbool.h>
#include <stdint.h>

struct bno055_reading {         /* fields of `tilt`; the vector is zero unless the status is "running" */
    int16_t x, y, z;
    uint8_t status;             /* enum tilt_status */
    uint8_t sys_status;
    uint8_t sys_error;
};

void bno055_start(uint32_t now_ms);
void bno055_poll(uint32_t now_ms);

/* A reading is asked for, and given back once it is there: at once while the sensor is being brought up. */
void bno055_ask(uint32_t now_ms);
bool bno055_answer(struct bno055_reading *reading);

#endif
