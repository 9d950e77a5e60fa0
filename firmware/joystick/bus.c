#include "bus.h"

/* The longest transaction, 9 bytes at 100 kHz with the clock stretched by 180 us each, takes 2.5 ms. */
enum { TIME_OUT_MS = 6 };

static uint32_t began_ms;

void bus_read(uint8_t address, uint8_t reg, uint8_t *to, uint8_t n, uint32_t now_ms)
{
    began_ms = now_ms;
    hal_bus_read(address, reg, to, n);
}

void bus_write(uint8_t address, uint8_t reg, uint8_t value, uint32_t now_ms)
{
    began_ms = now_ms;
    hal_bus_write(address, reg, value);
}

enum bus_state bus_poll(uint32_t now_ms)
{
    if (hal_bus_state() == BUS_BUSY && now_ms - began_ms > TIME_OUT_MS)
        hal_bus_abort();
    return hal_bus_state();
}
