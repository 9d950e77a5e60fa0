/* The edges of an encoder's disk, as the simulated world has them: two copies of it for both simulators of a board.
 *
 * A running index counts the edges that the disk has passed, forward positive: one turn after another, without end.
 */
#ifndef GIRAFF_ENCODER_DISK_H
#define GIRAFF_ENCODER_DISK_H
#include <math.h>
#include "board_model.h"

enum { LEVEL_A = 1, LEVEL_B = 2 };

static inline const struct encoder_disk *encoder_disk_of(const struct motor_model *model)
{
    static const double AT[4] = { 0, 1, 2, 3 };
    static const uint8_t LEVELS[4] = { 0, LEVEL_A, LEVEL_A | LEVEL_B, LEVEL_B };
    static const struct encoder_disk IDEAL = { 4, 4, AT, LEVELS };
    return model->disk ? model->disk : &IDEAL;
}

/* Number of the edge within its turn. */
static inline int encoder_edge(const struct encoder_disk *disk, int64_t index)
{
    int edge = (int)(index % disk->edges);
    return edge < 0 ? edge + disk->edges : edge;
}

/* Position from which on the index is this one. */
static inline double encoder_at(const struct motor_model *model, int64_t index)
{
    const struct encoder_disk *disk = encoder_disk_of(model);
    int edge = encoder_edge(disk, index);
    return (double)((index - edge) / disk->edges * disk->states) + disk->at[edge];
}

static inline int encoder_levels(const struct motor_model *model)
{
    const struct encoder_disk *disk = encoder_disk_of(model);
    return disk->levels[encoder_edge(disk, model->states)];
}

static inline int64_t encoder_index(const struct motor_model *model, double position)
{
    const struct encoder_disk *disk = encoder_disk_of(model);
    int64_t before = (int64_t)floor(position / disk->states) * disk->edges - 1;
    int passed = 0;
    while (passed < disk->edges && encoder_at(model, before + passed + 1) <= position)
        passed++;
    return before + passed;
}
#endif
