#include "held.h"
#include "protocol.h"

static const int32_t FROM_UM_S = HELD_FROM_UM_S;

bool held_judge(struct held *h, int32_t asked_um_s, int32_t um_s, uint16_t silent_ms)
{
    if (asked_um_s <= 0) {
        *h = (struct held){ 0 };
        return false;
    }
    h->has_turned = h->has_turned || um_s > 0;

    /* Who asks for less lets it get slower. */
    if (um_s > h->had_um_s)
        h->had_um_s = um_s;
    if (h->had_um_s > asked_um_s)
        h->had_um_s = asked_um_s;
    if (asked_um_s >= FROM_UM_S && h->had_um_s >= FROM_UM_S / 2 && um_s < h->had_um_s / 2)
        h->fallen_ms = (uint8_t)(h->fallen_ms + SPEED_PERIOD_MS);
    else
        h->fallen_ms = 0;
    if (h->fallen_ms >= HELD_FALLEN_MS)
        return true;

    if (asked_um_s < FROM_UM_S) {
        h->behind_ms = 0;
        return false;
    }
    if (h->has_turned && silent_ms >= SILENT_MS)
        return true;        /* from rest it is turning.c that judges: a first edge takes longer */
    h->behind_ms = um_s < asked_um_s / 2 ? (uint16_t)(h->behind_ms + SPEED_PERIOD_MS) : 0;
    return h->behind_ms >= HELD_REACH_MS;
}
