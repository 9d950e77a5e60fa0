#include "speedometer.h"

enum {
    OVERDUE = OVERDUE_MS * STAMPS_PER_MS,
    STANDS = 100 * STAMPS_PER_MS        /* without an edge for so long, a wheel counts as standing */
};

/* um/s of a way in 1/256 um that took so many stamps: way / 256 * STAMPS_PER_MS * 1000 / stamps, in 32 bits and with
 * one division, of which the board's processor has time for few. A way of more than 0.2 m counts as 0.2 m. */
static uint32_t rate(uint32_t way_q8, uint16_t stamps)
{
    _Static_assert(STAMPS_PER_MS * 1000l % 64 == 0, "a factor is exact");
    const uint32_t factor = STAMPS_PER_MS * 1000l / 64, most = UINT32_MAX / factor;
    if (way_q8 <= most)
        return way_q8 * factor / 4 / stamps;
    way_q8 /= 16;
    return (way_q8 < most ? way_q8 : most) * factor / 4 / stamps * 16;
}

static uint16_t magnitude(int16_t ticks)
{
    return (uint16_t)(ticks < 0 ? 0u - (uint16_t)ticks : (uint16_t)ticks);     /* also of INT16_MIN */
}

static void remember(struct speedometer *s, uint16_t ticks, uint16_t stamp)
{
    if (s->n < SPEEDOMETER_SPAN)
        s->n++;
    s->newest = (uint8_t)((s->newest + 1) % SPEEDOMETER_SPAN);
    s->seen[s->newest] = (struct seen){ ticks, stamp, s->now };
}

/* What was seen so many periods with an edge before the newest. */
static const struct seen *before(const struct speedometer *s, uint8_t n)
{
    return &s->seen[(uint8_t)(s->newest - n) % SPEEDOMETER_SPAN];
}

/* A wheel that trembles on an edge has edges close to each other, and gets nowhere: no speed is more than what its
 * ticks, and one more, make of the whole time. */
static int32_t mean(const struct speedometer *s, uint32_t um_per_tick_q8)
{
    const struct seen *newest = before(s, 0), *oldest = before(s, (uint8_t)(s->n - 1));
    uint16_t stamps = (uint16_t)(newest->stamp - oldest->stamp);
    int16_t turned = (int16_t)(newest->ticks - oldest->ticks);
    if (!stamps || !turned)
        return 0;
    uint16_t n = magnitude(turned), most_stamps = (uint16_t)(newest->now - oldest->now);
    if (most_stamps > stamps && (uint32_t)n * (uint16_t)(most_stamps - stamps) > stamps) {
        n++;
        stamps = most_stamps;
    }
    uint32_t speed = rate(n * um_per_tick_q8, stamps);
    return turned < 0 ? -(int32_t)speed : (int32_t)speed;
}

/* Each period that had an edge took a wheel that turns on by a tick at least. One that trembles on an edge
 * never comes as far as a second one. */
static bool gets_on(const struct speedometer *s)
{
    uint16_t turned = magnitude((int16_t)(before(s, 0)->ticks - before(s, (uint8_t)(s->n - 1))->ticks));
    return s->n > 2 && turned + 1u >= s->n;
}

/* As long as no edge comes, a wheel may have turned by one tick at most. */
static int32_t slowed(int32_t um_s, uint32_t um_per_tick_q8, uint16_t silent)
{
    int32_t most = silent < STANDS ? (int32_t)rate(um_per_tick_q8, silent) : 0;
    return um_s > most ? most : um_s < -most ? -most : um_s;
}

/* Without a division: the ticks go to the other side. */
static bool is_late(const struct speedometer *s)
{
    if (s->silent <= OVERDUE || s->silent > STANDS)
        return s->silent > STANDS;
    return s->between_stamps && (uint32_t)s->silent * s->between_ticks > (uint32_t)OVERDUE_INTERVALS * s->between_stamps;
}

void speedometer_step(struct speedometer *s, uint32_t um_per_tick_q8, uint16_t ticks, uint16_t stamp, uint16_t now)
{
    uint16_t passed = (uint16_t)(now - s->now);
    s->now = now;
    const struct seen *last = before(s, 0);
    if (s->n && ticks == last->ticks && stamp == last->stamp) {
        s->silent = s->silent > UINT16_MAX - passed ? UINT16_MAX : (uint16_t)(s->silent + passed);
        s->is_overdue = is_late(s) || !gets_on(s);
        if (s->silent)
            s->um_s = slowed(s->um_s, um_per_tick_q8, s->silent);
        return;
    }
    if (is_late(s))
        s->n = 0;           /* what it did before tells nothing of now */
    remember(s, ticks, stamp);
    int16_t since = (int16_t)(now - stamp);
    s->silent = since > 0 ? (uint16_t)since : 0;        /* an edge may come between the two readings of the time */
    s->is_overdue = !gets_on(s);
    if (s->n == 1) {
        s->between_ticks = 1;
        s->between_stamps = 0;
        return;
    }
    uint16_t turned = magnitude((int16_t)(ticks - last->ticks));
    s->between_ticks = turned > 1 ? turned : 1;
    s->between_stamps = (uint16_t)(stamp - last->stamp);
    s->um_s = mean(s, um_per_tick_q8);
}
