#include "settings.h"

enum { ALL_WIRING = 2 * WIRING_INVERT_RIGHT_ENCODER - 1 };

/* Wide: only what cannot be, and what would make some figure infinite or without meaning, is refused. */
static bool are_sound(const struct balance_configure *asked)
{
    const struct { uint32_t value, min, max; } bounds[] = {
        { asked->wiring, 0, ALL_WIRING },
        { asked->k1_mnm_rad, 1000, 100000000 },
        { asked->k2_mnm_s_rad, 100, 100000000 },
        { asked->k3_mnm_m, 0, 100000000 },
        { asked->k4_mnm_s_m, 0, 100000000 },
        { asked->gravity_mnm_rad, 1000, 10000000 },
        { asked->momentum_gms, 100, 10000000 },
        { asked->momentum_gm2, 10, 10000000 },
        { asked->radius_um, 10000, 1000000 },
        { asked->track_um, 50000, 3000000 },
        { asked->counts_per_turn, 16, UINT16_MAX },
        { asked->motor_mv_s, 10, UINT16_MAX },
        { asked->motor_mohm, 10, UINT16_MAX },
        { asked->torque_max_mnm, 100, 10000000 },
        { asked->acceleration_mm_s2, 10, UINT16_MAX },
        { asked->braking_mm_s2, 10, UINT16_MAX },
        { asked->speed_max_mm_s, 1, 10000 },
        { asked->turn_max_mrad_s, 1, 20000 },
        { asked->battery_uv_count, 1000, UINT16_MAX },
        { asked->driver_min_mv, 6000, 30000 },
        { asked->battery_min_mv, asked->driver_min_mv, 30000 },
    };
    for (uint8_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        if (bounds[i].value < bounds[i].min || bounds[i].value > bounds[i].max)
            return false;
    }
    return !asked->k3_mnm_m == !asked->k4_mnm_s_m;
}

static float thousandths(uint32_t value)
{
    return (float)value / 1000;
}

bool settings_read(const struct balance_configure *asked, struct balance_settings *settings)
{
    if (!are_sound(asked))
        return false;
    *settings = (struct balance_settings){
        .k1 = thousandths(asked->k1_mnm_rad),
        .k2 = thousandths(asked->k2_mnm_s_rad),
        .k3 = thousandths(asked->k3_mnm_m),
        .k4 = thousandths(asked->k4_mnm_s_m),
        .gravity = thousandths(asked->gravity_mnm_rad),
        .momentum_per_speed = thousandths(asked->momentum_gms),
        .momentum_per_rate = thousandths(asked->momentum_gm2),
        .radius = thousandths(asked->radius_um) / 1000,
        .track = thousandths(asked->track_um) / 1000,
        .rad_per_count = 6.2831853f / (float)asked->counts_per_turn,
        .motor_constant = thousandths(asked->motor_mv_s),
        .motor_ohm = thousandths(asked->motor_mohm),
        .friction = thousandths(asked->friction_mnm),
        .torque_max = thousandths(asked->torque_max_mnm),
        .acceleration = thousandths(asked->acceleration_mm_s2),
        .braking = thousandths(asked->braking_mm_s2),
        .speed_max = thousandths(asked->speed_max_mm_s),
        .turn_max = thousandths(asked->turn_max_mrad_s),
        .volts_min = thousandths(asked->battery_min_mv),
    };
    return true;
}
