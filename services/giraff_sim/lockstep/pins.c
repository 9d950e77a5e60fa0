#include <string.h>
#include "inside.h"

avr_io_t *io_next(avr_t *avr, const char *kind, avr_io_t *after)
{
    for (avr_io_t *io = after ? after->next : avr->io_port; io; io = io->next)
        if (!strcmp(io->kind, kind))
            return io;
    return NULL;
}

avr_timer_t *timer_named(avr_t *avr, char name)
{
    for (avr_io_t *io = io_next(avr, "timer", NULL); io; io = io_next(avr, "timer", io))
        if (((avr_timer_t *)io)->name == name)
            return (avr_timer_t *)io;
    return NULL;
}

struct pin pin_named(avr_t *avr, const char *name)
{
    for (avr_io_t *io = io_next(avr, "port", NULL); io; io = io_next(avr, "port", io))
        if (((avr_ioport_t *)io)->name == name[0])
            return (struct pin){ (avr_ioport_t *)io, name[1] - '0' };
    return (struct pin){ NULL, 0 };
}

void pin_drive(struct board_model *b, struct pin pin, int level)
{
    uint8_t mask = (uint8_t)(1 << pin.bit);
    /* TRAP: a write to PORTx raises every input pin whose pull-up is on, driven low or not, unless the level
     * is also declared as external; this is the place where it survives a reset, too. */
    pin.port->external.pull_mask |= mask;
    pin.port->external.pull_value = (uint8_t)(level ? pin.port->external.pull_value | mask
                                                    : pin.port->external.pull_value & ~mask);
    /* TRAP: an INTn pin driven low while its strict level trigger is on starts a poll that never ends, and it
     * is on from each reset until after_reset: pins_restore drives the pin then. */
    if (!b->inside->was_reset)
        avr_raise_irq(pin.port->io.irq + pin.bit, (uint32_t)!!level);
}

int pin_output(avr_t *avr, struct pin pin)
{
    if (!(avr->data[pin.port->r_ddr] >> pin.bit & 1))
        return -1;
    return avr->data[pin.port->r_port] >> pin.bit & 1;
}

void pins_restore(avr_t *avr)
{
    for (avr_io_t *io = io_next(avr, "port", NULL); io; io = io_next(avr, "port", io)) {
        avr_ioport_t *port = (avr_ioport_t *)io;
        for (int bit = 0; bit < 8; bit++) {
            if (!(port->external.pull_mask >> bit & 1))
                continue;
            /* TRAP: a reset clears PINx, but the filtered IRQ keeps the old level and would swallow it. */
            io->irq[bit].flags |= IRQ_FLAG_INIT;
            avr_raise_irq(io->irq + bit, port->external.pull_value >> bit & 1);
        }
    }
}

void register_watch(avr_t *avr, avr_io_addr_t address, avr_irq_notify_t changed, void *param)
{
    avr_irq_register_notify(avr_iomem_getirq(avr, address, NULL, AVR_IOMEM_IRQ_ALL), changed, param);
}

void pin_watch(avr_t *avr, struct pin pin, avr_irq_notify_t changed, void *param)
{
    register_watch(avr, pin.port->r_port, changed, param);
    register_watch(avr, pin.port->r_ddr, changed, param);
}
