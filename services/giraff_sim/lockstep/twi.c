/* A slave with 256 registers and an auto-incrementing pointer. What the registers mean is the world's. */
#include "inside.h"

static void acknowledge(struct board_private *in)
{
    avr_raise_irq(in->twi_input, avr_twi_irq_msg(TWI_COND_ACK, in->twi_selected, 1));
}

static void on_message(avr_irq_t *irq, uint32_t value, void *param)
{
    struct board_model *b = param;
    struct board_private *in = b->inside;
    avr_twi_msg_irq_t message = { .u.v = value };
    uint8_t what = (uint8_t)message.u.twi.msg, address = (uint8_t)message.u.twi.addr;
    (void)irq;
    if (what & TWI_COND_STOP)
        in->twi_selected = 0;
    if (what & TWI_COND_START) {
        in->twi->state &= (uint8_t)~TWI_COND_WRITE;     /* TRAP: else SLA+W reports 0x28 in place of 0x18 */
        in->twi_index = 0;
        in->twi_selected = b->twi_address && address >> 1 == b->twi_address ? address : 0;
        if (in->twi_selected)
            acknowledge(in);
    }
    if (!in->twi_selected)
        return;
    if (what & TWI_COND_WRITE) {
        acknowledge(in);
        if (in->twi_index++ == 0)
            in->twi_pointer = (uint8_t)message.u.twi.data;
        else
            b->twi_register[in->twi_pointer++] = (uint8_t)message.u.twi.data;
    }
    if (what & TWI_COND_READ) {
        b->twi_reads++;
        uint8_t data = b->twi_register[in->twi_pointer++];
        avr_raise_irq(in->twi_input, avr_twi_irq_msg(TWI_COND_READ, in->twi_selected, data));
    }
}

int twi_wire(struct board_model *b)
{
    struct board_private *in = b->inside;
    in->twi = (avr_twi_t *)io_next(in->avr, "twi", NULL);
    if (!in->twi)
        return -1;
    in->twi->twi.raise_sticky = 0;      /* TRAP: else TWINT stays 1 after it was written */
    in->twi_input = in->twi->io.irq + TWI_IRQ_INPUT;
    avr_irq_register_notify(in->twi->io.irq + TWI_IRQ_OUTPUT, on_message, b);
    return 0;
}

void twi_restore(struct board_model *b)
{
    b->inside->twi_selected = 0;        /* a reset in mid-transfer: the slave sees the bus released */
}
