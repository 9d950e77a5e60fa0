/* Encoders: quadrature on the pins, as the wheels' positions have it. */
#include "encoder_disk.h"
#include "inside.h"

/* A != B just after A's edge is forward, or A == B on a mirrored encoder. */
static void present(struct board_model *b, struct encoder *e)
{
    int levels = encoder_levels(&b->motor[e->number]);
    pin_drive(b, e->b, ((levels & LEVEL_B) != 0) ^ e->mirrored);
    pin_drive(b, e->a, (levels & LEVEL_A) != 0);
}

/* Cycle of the slice's next edge, 0: none. The position moves linearly from `from` to `to`, so the
 * true position and the count cannot drift apart. */
static avr_cycle_count_t next_edge(const struct board_model *b, const struct encoder *e)
{
    const struct motor_model *model = &b->motor[e->number];
    const struct board_private *in = b->inside;
    double step = e->to - e->from, at;
    if (model->encoder_cut)
        return 0;
    if (e->to >= encoder_at(model, model->states + 1))
        at = encoder_at(model, model->states + 1);
    else if (e->to < encoder_at(model, model->states))
        at = encoder_at(model, model->states);
    else
        return 0;
    double part = step == 0 ? 0 : (at - e->from) / step;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    return in->start + (avr_cycle_count_t)(part * (double)(in->end - in->start));
}

static avr_cycle_count_t on_edge(avr_t *avr, avr_cycle_count_t when, void *param)
{
    struct encoder *e = param;
    struct motor_model *model = &e->board->motor[e->number];
    (void)avr;
    model->states += e->to >= encoder_at(model, model->states + 1) ? 1 : -1;
    present(e->board, e);
    avr_cycle_count_t next = next_edge(e->board, e);
    return next && next <= when ? when + 1 : next;
}

void encoder_wire(struct board_model *b, int number, const char *pin_a, const char *pin_b, int mirrored)
{
    struct encoder *e = &b->inside->encoder[number];
    *e = (struct encoder){ .board = b, .number = number, .mirrored = mirrored,
                           .a = pin_named(b->inside->avr, pin_a), .b = pin_named(b->inside->avr, pin_b) };
    present(b, e);
}

void encoders_begin(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct encoder *e = &b->inside->encoder[k];
        e->from = e->to;
        e->to = b->motor[k].position;
        if (e->board && e->was_cut && !b->motor[k].encoder_cut) {
            b->motor[k].states = encoder_index(&b->motor[k], e->from);
            present(b, e);
        }
        e->was_cut = b->motor[k].encoder_cut;
    }
}

void encoders_arm(struct board_model *b)
{
    avr_t *avr = b->inside->avr;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct encoder *e = &b->inside->encoder[k];
        if (!e->board)
            continue;
        avr_cycle_count_t at = next_edge(b, e);
        if (at)
            avr_cycle_timer_register(avr, at > avr->cycle ? at - avr->cycle : 0, on_edge, e);
    }
}

void encoders_stand_still(struct board_model *b)
{
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct encoder *e = &b->inside->encoder[k];
        if (!e->board)
            continue;
        e->to = b->motor[k].position;
        b->motor[k].states = encoder_index(&b->motor[k], e->to);
        present(b, e);
    }
}
