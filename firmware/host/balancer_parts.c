/* The parts of a balancing robot's board: analogue sensors, encoders, a motor driver on a serial line, a cord. */
#include <math.h>
#include "balancer_protocol.h"
#include "driver.h"
#include "encoders.h"
#include "hal_balancer.h"
#include "machine.h"
#include "sabertooth_driver.h"
#include "sensors.h"
#include "shafts.h"

enum { MS_NS = 1000000, BYTE_NS = 1000000000 / DRIVER_BAUD * 10 };
static const enum source CONVERSIONS = PART_2, DRIVER_BYTE = PART_3;
static const double AREF_VOLTS = 3.3;

static uint8_t encoder_pins;
static double sensor_volts[BATTERY];            /* a millisecond ago */
static struct sabertooth_driver driver;
static uint8_t sending;                         /* the byte on its way to the driver */

static double now_us(void)
{
    return (double)machine_now_ns() / 1000;
}

static void present(int k, int a, int b)
{
    encoder_pins = (uint8_t)((encoder_pins & ~(3 << 2 * k)) | (a | b << 1) << 2 * k);
    encoders_on_change(encoder_pins);
}

void hal_start_encoders(void)
{
}

uint8_t hal_encoder_pins(void)
{
    return encoder_pins;
}

static void convert(uint8_t sensor, double volts)
{
    sensors_on_conversion(sensor, (uint16_t)fmin(fmax(volts / AREF_VOLTS * 1024, 0), 1023));
}

/* Those of a millisecond at once: each sensor twice, of which once on the way there, and the battery once. */
static void convert_all(void)
{
    for (uint8_t i = 0; i < BATTERY; i++) {
        double volts = machine_board->sensor_volts[i];
        convert(i, (sensor_volts[i] + volts) / 2);
        convert(i, volts);
        sensor_volts[i] = volts;
    }
    convert(BATTERY, machine_board->battery_volts);
    machine_schedule(CONVERSIONS, machine_now_ns() + MS_NS);
}

void hal_start_sensors(void)
{
    machine_schedule(CONVERSIONS, machine_now_ns() + MS_NS);
}

static void send_next(void)
{
    int16_t byte = driver_on_transmit();
    if (byte < 0)
        return;
    sending = (uint8_t)byte;
    machine_schedule(DRIVER_BYTE, machine_now_ns() + BYTE_NS);
}

void hal_start_driver(void)
{
}

void hal_driver_transmit(void)
{
    if (!machine_is_scheduled(DRIVER_BYTE))
        send_next();
}

void hal_start_cord(void)
{
}

bool hal_cord_is_pulled(void)
{
    return machine_board->cord_pulled;
}

void parts_on_event(int part)
{
    if (part < BOARD_MOTORS) {
        shafts_on_event(part);
    } else if ((enum source)part == CONVERSIONS) {
        convert_all();
    } else {
        sabertooth_byte(&driver, sending, now_us());
        send_next();
    }
}

void parts_open(void)
{
    encoder_pins = 0;
    shafts_open(present);
    driver = (struct sabertooth_driver){ .board = machine_board };
}

void parts_reset(void)
{
    machine_cancel(CONVERSIONS);
    machine_cancel(DRIVER_BYTE);
}

void parts_begin(uint64_t until_ns)
{
    sabertooth_begin(&driver, now_us());
    shafts_begin(until_ns);
}

void parts_end(void)
{
    sabertooth_end(&driver, now_us());
}
