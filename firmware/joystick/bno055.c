#include "bno055.h"
#include "bus.h"
#include "protocol.h"

enum { ADDRESS = 0x28 };        /* COM3 low, as the shield has it (datasheet 4.6) */

enum reg {                      /* page 0 (datasheet 4.2) */
    CHIP_ID = 0x00,
    ACC_ID = 0x01,
    ACC_DATA_X_LSB = 0x08,
    ST_RESULT = 0x36,
    SYS_STATUS = 0x39,
    UNIT_SEL = 0x3B,
    OPR_MODE = 0x3D,
};

enum {
    CHIP_ID_BNO055 = 0xA0,
    ACC_ID_BNO055 = 0xFB,
    PASSED = 0x09,              /* ST_RESULT: processor and accelerometer; the other two sensors are not used */
    UNIT_M_S2 = 0x00,           /* UNIT_SEL */
    MODE_CONFIG = 0x00,         /* OPR_MODE */
    MODE_ACCONLY = 0x01,
    RUNNING_NO_FUSION = 6,      /* SYS_STATUS */

    RESET_MS = 300,
    START_MS = 1000,            /* 650 from a reset (datasheet 1.2), and some */
    RETRY_MS = 10,
    FIRST_MODE_MS = 30,         /* after the first mode write, else it may stall at power-on */
    RUNNING_MS = 30,            /* 7 for the mode (datasheet 3.3), 16 for a first value at 62.5 Hz */

    FAILURES_MAX = 5,           /* readings in a row, then the sensor is brought up anew */
};

/* The bring-up, from the sensor's reset to its first reading. */
static const struct step {
    enum { EXPECT, WRITE } action;
    uint8_t reg;
    uint8_t value;
    uint8_t mask;               /* EXPECT: the bits of value that count */
    uint16_t patience_ms;       /* EXPECT: how long to ask again */
    uint16_t wait_ms;           /* WRITE: before the next step */
    uint8_t failure;            /* EXPECT: what another value means */
} steps[] = {
    { EXPECT, CHIP_ID, CHIP_ID_BNO055, 0xFF, START_MS, 0, TILT_WRONG_CHIP },
    { EXPECT, ACC_ID, ACC_ID_BNO055, 0xFF, 0, 0, TILT_WRONG_CHIP },
    { EXPECT, ST_RESULT, PASSED, PASSED, 0, 0, TILT_SELF_TEST_FAILED },
    { WRITE, OPR_MODE, MODE_CONFIG, 0, 0, FIRST_MODE_MS, 0 },
    { WRITE, UNIT_SEL, UNIT_M_S2, 0, 0, 0, 0 },
    { WRITE, OPR_MODE, MODE_ACCONLY, 0, 0, RUNNING_MS, 0 },
};

enum { STEPS = sizeof steps / sizeof *steps };

enum phase {
    RESETTING,                  /* the reset line is low */
    WAITING,                    /* before step `step`, or before readings when there is none left */
    STEPPING,                   /* its transaction is under way */
    READY,                      /* to be asked for a reading */
    READING_DATA,
    READING_STATUS,
};

static enum phase phase;
static uint32_t since_ms;       /* RESETTING and WAITING: their beginning */
static uint16_t wait_ms;        /* WAITING: its length */
static uint8_t step;
static uint32_t step_began_ms;
static uint8_t failures;
static uint8_t bytes[6];
static bool answered;
static struct bno055_reading reading;

static void reset(uint32_t now_ms)
{
    hal_bus_abort();
    hal_hold_sensor_in_reset(true);
    phase = RESETTING;
    since_ms = now_ms;
}

static void wait(uint16_t for_ms, uint32_t now_ms)
{
    phase = WAITING;
    since_ms = now_ms;
    wait_ms = for_ms;
}

static void begin_step(uint32_t now_ms)
{
    phase = STEPPING;
    if (steps[step].action == EXPECT)
        bus_read(ADDRESS, steps[step].reg, bytes, 1, now_ms);
    else
        bus_write(ADDRESS, steps[step].reg, steps[step].value, now_ms);
}

static void end_step(bool answers, uint32_t now_ms)
{
    const struct step *s = &steps[step];
    if (answers && (s->action == WRITE || (bytes[0] & s->mask) == s->value)) {
        step++;
        step_began_ms = now_ms + s->wait_ms;
        wait(s->wait_ms, now_ms);
    } else if (now_ms - step_began_ms < s->patience_ms) {
        wait(RETRY_MS, now_ms);
    } else {
        /* The failure stays the status until a reading succeeds: who watches shall see why, not "starting". */
        reading.status = answers ? s->failure : TILT_BUS_FAULT;
        reset(now_ms);
    }
}

/* A reading has ended. */
static void conclude(uint8_t status, uint32_t now_ms)
{
    phase = READY;
    answered = true;
    reading.status = status;
    if (status == TILT_RUNNING) {
        failures = 0;
        return;
    }
    reading.x = reading.y = reading.z = 0;
    if (++failures >= FAILURES_MAX)
        reset(now_ms);
}

static int16_t word_at(uint8_t at)
{
    return (int16_t)(bytes[at] | (uint16_t)((uint16_t)bytes[at + 1] << 8));
}

static void take_data(uint32_t now_ms)
{
    reading.x = word_at(0);
    reading.y = word_at(2);
    reading.z = word_at(4);
    if (reading.x || reading.y || reading.z) {
        phase = READING_STATUS;
        bus_read(ADDRESS, SYS_STATUS, bytes, 2, now_ms);
    } else {
        conclude(TILT_BUS_FAULT, now_ms);       /* gravity is never zero */
    }
}

static void take_status(uint32_t now_ms)
{
    reading.sys_status = bytes[0];
    reading.sys_error = bytes[1];
    conclude(reading.sys_status == RUNNING_NO_FUSION ? TILT_RUNNING : TILT_SYSTEM_ERROR, now_ms);
}

void bno055_start(uint32_t now_ms)
{
    reading.status = TILT_STARTING;
    reset(now_ms);
}

static void poll_bus(uint32_t now_ms)
{
    enum bus_state bus = bus_poll(now_ms);
    if (bus == BUS_BUSY)
        return;
    if (phase == STEPPING)
        end_step(bus == BUS_DONE, now_ms);
    else if (bus == BUS_FAILED)
        conclude(TILT_BUS_FAULT, now_ms);
    else if (phase == READING_DATA)
        take_data(now_ms);
    else
        take_status(now_ms);
}

void bno055_poll(uint32_t now_ms)
{
    switch (phase) {
    case RESETTING:
        if (now_ms - since_ms < RESET_MS)
            return;
        hal_hold_sensor_in_reset(false);
        step = 0;
        step_began_ms = now_ms;
        failures = 0;
        wait(0, now_ms);
        return;
    case WAITING:
        if (now_ms - since_ms < wait_ms)
            return;
        if (step < STEPS)
            begin_step(now_ms);
        else
            phase = READY;
        return;
    case READY:
        return;
    default:
        poll_bus(now_ms);
    }
}

void bno055_ask(uint32_t now_ms)
{
    answered = phase != READY;
    if (answered)
        return;
    phase = READING_DATA;
    bus_read(ADDRESS, ACC_DATA_X_LSB, bytes, sizeof bytes, now_ms);
}

bool bno055_answer(struct bno055_reading *to)
{
    if (answered)
        *to = reading;
    return answered;
}
