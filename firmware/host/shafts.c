#include <math.h>
#include "encoder_disk.h"
#include "machine.h"
#include "shafts.h"

static struct encoder {
    double from, to;                /* position at the slice's ends, quadrature states */
    int was_cut;
} encoders[BOARD_MOTORS];

static uint64_t slice_from_ns, slice_to_ns;
static void (*present_to)(int k, int a, int b);

static void present(int k)
{
    int levels = encoder_levels(&machine_board->motor[k]);
    present_to(k, (levels & LEVEL_A) != 0, (levels & LEVEL_B) != 0);
}

/* The position moves evenly from `from` to `to`, and the edges are counted up to it: they cannot drift apart. */
static void schedule_edge(int k)
{
    const struct encoder *e = &encoders[k];
    const struct motor_model *model = &machine_board->motor[k];
    double at;
    if (model->encoder_cut)
        return;
    if (e->to >= encoder_at(model, model->states + 1))
        at = encoder_at(model, model->states + 1);
    else if (e->to < encoder_at(model, model->states))
        at = encoder_at(model, model->states);
    else
        return;
    double part = e->to == e->from ? 0 : (at - e->from) / (e->to - e->from);
    part = fmin(fmax(part, 0), 1);
    machine_schedule(PART_0 + (enum source)k,
                     slice_from_ns + (uint64_t)(part * (double)(slice_to_ns - slice_from_ns)));
}

void shafts_on_event(int k)
{
    struct motor_model *model = &machine_board->motor[k];
    model->states += encoders[k].to >= encoder_at(model, model->states + 1) ? 1 : -1;
    present(k);
    schedule_edge(k);
}

void shafts_open(void (*to)(int k, int a, int b))
{
    present_to = to;
    for (int k = 0; k < BOARD_MOTORS; k++)
        encoders[k] = (struct encoder){ 0 };
    slice_to_ns = 0;
}

void shafts_begin(uint64_t until_ns)
{
    slice_from_ns = machine_now_ns();
    slice_to_ns = until_ns;
    for (int k = 0; k < BOARD_MOTORS; k++) {
        struct encoder *e = &encoders[k];
        struct motor_model *model = &machine_board->motor[k];
        e->from = e->to;
        e->to = model->position;
        if (e->was_cut && !model->encoder_cut) {
            model->states = encoder_index(model, e->from);
            present(k);
        }
        e->was_cut = model->encoder_cut;
        schedule_edge(k);
    }
}
