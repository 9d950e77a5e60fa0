#include "speed.h"
#include "wiring.h"

enum {
    PERIODS_PER_S = 1000 / SPEED_PERIOD_MS,
    ADC_MAX = 1023,
    SMOOTHING = 16,                 /* of the battery's voltage: periods */
    SHORT_FOR = 50,                 /* periods that a wheel may be short without being at its limit: it speeds up */
    LOST_MAX_Q15 = 24576,
    GROWTH_SMOOTHING_BITS = 2,      /* over 4 periods: a host's ramp comes in steps, one in two or three of them */
    UM_S_MAX = 10000000,            /* faster is no robot, and nothing overflows */
    FORWARD_MAX_Q23 = UINT32_MAX / 16384 / 2,
    MOTOR_MS_MAX = 2000,
    MOST_Q8 = (100 + PWM_OVER_PERCENT) * 256l / 100,
    MOST_BLIND_Q8 = (100 + PWM_OVER_BLIND_PERCENT) * 256l / 100,
    PULLED_FOR = 5,                 /* periods in which a wheel against what is asked gets no slower: something pulls it */
    DUE_Q8 = 85,                    /* share by which what is due comes up to what is set in a period */
    LIMIT_Q15 = 328,                /* of what is set: told as SPEED_AT_LIMIT */
    SHORT_SHARE = 64,               /* a wheel that lacks less than this part of what it is asked for is not short */
};

static int32_t clamped(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

static int32_t magnitude(int32_t value)
{
    return value < 0 ? -value : value;
}

/* value / 2^bits. The board's compiler divides signed values by powers of two in 650 cycles, as by any other. */
static int32_t shifted(int32_t value, uint8_t bits)
{
    return value < 0 ? -(int32_t)((0 - (uint32_t)value) >> bits) : (int32_t)((uint32_t)value >> bits);
}

static bool gains_configure(struct gains *gains, uint16_t p, uint16_t i)
{
    uint64_t p_q24 = ((uint64_t)p << 24) / 1000000;
    uint64_t i_q24 = ((uint64_t)i << 24) / (1000000 * PERIODS_PER_S);
    if (p_q24 > UINT16_MAX || i_q24 > UINT16_MAX)
        return false;
    gains->p_q24 = (uint16_t)p_q24;
    gains->i_q24 = (uint16_t)i_q24;
    gains->error_max = INT32_MAX / (int32_t)(1 + (p_q24 > i_q24 ? p_q24 : i_q24));
    return true;
}

bool speed_configure(struct speed_settings *settings, const struct configure *asked)
{
    struct speed_settings made = {
        .step_um_s = (int32_t)(asked->acceleration_um_s2 / PERIODS_PER_S),
        .nominal_adc_counts = asked->nominal_adc_counts,
        .motor_periods_q8 = (uint16_t)(asked->motor_ms * 256ul / SPEED_PERIOD_MS),
        .pwm_max = asked->pwm_max,
        .stall_pwm = asked->stall_pwm,
        .dead_pwm = asked->dead_pwm,
    };
    const uint32_t counts_per_km[WHEELS] = { asked->left_counts_per_km, asked->right_counts_per_km };
    for (uint8_t wheel = 0; wheel < WHEELS; wheel++) {
        uint64_t um_per_tick_q8 = counts_per_km[wheel] ? 256 * 1000000000ull / counts_per_km[wheel] : 0;
        if (um_per_tick_q8 > UINT32_MAX || (asked->speed_max_um_s && !um_per_tick_q8))
            return false;
        made.um_per_tick_q8[wheel] = (uint32_t)um_per_tick_q8;
    }
    if (asked->speed_max_um_s) {
        if (asked->speed_max_um_s > UM_S_MAX || made.step_um_s <= 0 || asked->acceleration_um_s2 > INT32_MAX)
            return false;
        if (!asked->nominal_um_s || asked->motor_ms > MOTOR_MS_MAX)
            return false;
        if (asked->nominal_adc_counts > ADC_MAX || !asked->stall_pwm)
            return false;
        if (asked->dead_pwm > asked->stall_pwm || asked->stall_pwm > asked->pwm_max)
            return false;
        if (!gains_configure(&made.wheel, asked->speed_p, asked->speed_i))
            return false;
        if (!gains_configure(&made.turn, asked->turn_p, asked->turn_i))
            return false;
        made.forward_q23 = ((uint32_t)asked->nominal_level << 23) / asked->nominal_um_s;
        if (!made.forward_q23 || made.forward_q23 > FORWARD_MAX_Q23)
            return false;
        uint32_t most_q23 = made.forward_q23 * 2 + 1;       /* with a battery at its lowest */
        if ((uint64_t)most_q23 * asked->speed_max_um_s > UINT32_MAX)
            return false;
        made.forward_max_um_s = (int32_t)(UINT32_MAX / most_q23);
    }
    *settings = made;
    return true;
}

/* Up by a step at most, down at once. */
static int32_t ramped(int32_t set, int32_t asked, int32_t step)
{
    return asked < 0 ? clamped(asked, set - step, 0) : clamped(asked, 0, set + step);
}

/* Whether wheels that turn against what is asked roll out by themselves. A wheel that something pulls soon gets no
 * slower: waiting would not turn it round. */
static bool roll_out(struct speed_control *s, uint16_t against)
{
    if (!against) {
        s->least_against = UINT16_MAX;
        s->no_slower_for = 0;
    } else if (against < s->least_against && s->no_slower_for < PULLED_FOR) {
        s->least_against = against;
        s->no_slower_for = 0;
    } else if (s->no_slower_for < PULLED_FOR) {
        s->no_slower_for++;
    }
    return against && s->no_slower_for < PULLED_FOR;
}

/* Most that a speed grows now. Wheels that roll out are braked by a slow speed: a ramp that ran ahead of them would be
 * caught up with at once when they turn round. Both wait, so that the curve stays. */
static int32_t growth_max(const struct speed_wheel *wheel, int32_t step, bool rolls_out)
{
    const int32_t braking_um_s = HELD_FROM_UM_S;
    return rolls_out ? clamped(braking_um_s - magnitude(wheel->ramp_um_s), 0, step) : step;
}

static int32_t smoothed(int32_t set, int32_t wanted)
{
    int32_t growth = magnitude(wanted) - magnitude(set);
    if (growth <= 1 << GROWTH_SMOOTHING_BITS)
        return wanted;
    return set + shifted(wanted - set, GROWTH_SMOOTHING_BITS);
}

static void smooth_battery(struct speed_control *s, uint16_t adc_counts)
{
    uint16_t newest_q4 = (uint16_t)(adc_counts * SMOOTHING);
    s->battery_q4 = s->battery_q4 ? (uint16_t)(s->battery_q4 - s->battery_q4 / SMOOTHING + adc_counts) : newest_q4;
}

/* 2^14 * part / of, where part is less than twice `of` and neither more than INT16_MAX: in a third of a division's
 * cycles. */
static uint16_t ratio_q14(uint16_t part, uint16_t of)
{
    uint16_t ratio = part >= of;
    if (ratio)
        part = (uint16_t)(part - of);
    for (uint8_t bit = 0; bit < 14; bit++) {
        part = (uint16_t)(part << 1);
        ratio = (uint16_t)(ratio << 1);
        if (part >= of) {
            part = (uint16_t)(part - of);
            ratio |= 1;
        }
    }
    return ratio;
}

/* A reading far from any battery that drives is none: a wire that is off must not make the motors strong. */
static bool knows_battery(const struct speed_control *s, const struct speed_settings *settings)
{
    uint16_t nominal_q4 = (uint16_t)(settings->nominal_adc_counts * SMOOTHING);
    uint16_t low = (uint16_t)(nominal_q4 * 43691ul / 65536), high = (uint16_t)(nominal_q4 + nominal_q4 / 2);
    return nominal_q4 && s->battery_q4 >= low && s->battery_q4 <= high;
}

/* PWM counts * 2^23 for each um/s with the battery as it is. */
static uint32_t forward_now_q23(const struct speed_control *s, const struct speed_settings *settings)
{
    if (!knows_battery(s, settings))
        return settings->forward_q23;
    uint16_t more_q14 = ratio_q14((uint16_t)(settings->nominal_adc_counts * SMOOTHING), s->battery_q4);
    return settings->forward_q23 * more_q14 / 16384;
}

/* PWM counts * 256 that turn a healthy wheel at a speed. */
static uint32_t feed_forward_q8(const struct speed_settings *settings, uint32_t forward_q23, int32_t um_s)
{
    return (uint32_t)clamped(um_s, 0, settings->forward_max_um_s) * forward_q23 / 65536 * 2;
}

static int32_t proportional_q8(const struct gains *gains, int32_t error)
{
    return shifted(clamped(error, -gains->error_max, gains->error_max) * gains->p_q24, 16);
}

static int32_t grown_q16(const struct gains *gains, int32_t integral_q16, int32_t error)
{
    return integral_q16 + shifted(clamped(error, -gains->error_max, gains->error_max) * gains->i_q24, 8);
}

/* What is not asked for of a speed, which is positive. */
static int32_t lost(const struct speed_control *s, int32_t um_s)
{
    return (int32_t)((uint32_t)um_s / 256 * (s->lost_q15 * 2ul) / 256);
}

static int32_t along(int8_t direction, int32_t value)
{
    return direction > 0 ? value : direction < 0 ? -value : 0;
}

/* What a wheel may get, and whether its loop works. All in the direction that is set. */
struct room {
    int8_t direction;               /* 1, -1; 0 = it is to stand */
    int32_t target, due, speed;     /* um/s */
    int32_t forward_q8, most_q8;
    bool is_closed;
};

static void find_room(
    struct room *room, const struct speed_control *s, const struct speed_settings *settings, uint32_t forward_q23,
    uint8_t number)
{
    const struct speed_wheel *wheel = &s->wheel[number];
    int32_t set = magnitude(wheel->set_um_s);
    room->direction = wheel->set_um_s > 0 ? 1 : wheel->set_um_s < 0 ? -1 : 0;
    room->target = set - lost(s, set);
    room->due = magnitude(wheel->due_um_s);
    room->due -= lost(s, room->due);
    room->speed = along(room->direction, wheel->speedometer.um_s);
    uint16_t most_of_q8 = knows_battery(s, settings) ? MOST_Q8 : MOST_BLIND_Q8;
    int32_t dead_q8 = settings->dead_pwm * 256l;
    /* What a motor needs to speed up, as one of first order does. */
    int32_t lead = (int32_t)((uint32_t)wheel->growth_um_s * settings->motor_periods_q8 / 256);
    uint32_t full_q8 = feed_forward_q8(settings, forward_q23, set + lead) + (uint32_t)dead_q8;
    room->most_q8 = clamped((int32_t)(full_q8 * most_of_q8 / 256), dead_q8, settings->pwm_max * 256l);
    int32_t forward_q8 = (int32_t)feed_forward_q8(settings, forward_q23, room->target + lead);
    room->forward_q8 = clamped(forward_q8, dead_q8, room->most_q8);
    /* One that turns against what is set gets its feed-forward: a loop would only gather what it has to give back. */
    room->is_closed = room->direction && !wheel->speedometer.is_overdue && room->speed >= 0;
}

/* One wheel's output, of which the turn loop wants turn_q8 more; whether it is short. */
static bool drive_wheel(
    struct speed_wheel *wheel, const struct speed_settings *settings, const struct room *room, int32_t turn_q8)
{
    int32_t pwm_q8 = room->forward_q8;
    bool is_short = false;
    if (!room->direction) {
        wheel->integral_q16 = 0;
        pwm_q8 = 0;
    } else if (wheel->speedometer.is_overdue) {
        pwm_q8 = clamped(pwm_q8, 0, settings->stall_pwm * 256l);
    } else if (room->is_closed) {
        int32_t error = room->due - room->speed;
        int32_t own_q8 = proportional_q8(&settings->wheel, error) + shifted(wheel->integral_q16, 8);
        int32_t wanted_q8 = pwm_q8 + own_q8 + turn_q8;
        pwm_q8 = clamped(wanted_q8, 0, room->most_q8);
        bool would_wind = (wanted_q8 > pwm_q8 && error > 0) || (wanted_q8 < pwm_q8 && error < 0);
        if (!would_wind && wheel->speedometer.n == SPEEDOMETER_SPAN) {
            int32_t grown = grown_q16(&settings->wheel, wheel->integral_q16, error);
            wheel->integral_q16 =
                clamped(grown, -room->forward_q8 * 256, (room->most_q8 - room->forward_q8) * 256);
        }
        is_short = pwm_q8 == room->most_q8 && error > (int32_t)((uint32_t)room->target / SHORT_SHARE);
    }
    wheel->pwm_q8 = along(room->direction, pwm_q8);
    return is_short;
}

/* Both wheels are asked for less alike, so that the curve stays, until the one that cannot can; slowly for more when
 * none needs all that it may have. */
static void share_the_limit(struct speed_control *s, bool is_short, bool has_room)
{
    if (!is_short)
        s->short_for -= s->short_for ? 1 : 0;       /* asked for less, it is not short for a moment */
    else if (s->short_for < SHORT_FOR)
        s->short_for++;
    else if (s->lost_q15 < LOST_MAX_Q15)
        s->lost_q15 = (uint16_t)(s->lost_q15 + (32768u - s->lost_q15) / 128);
    if (has_room)
        s->lost_q15 = s->lost_q15 > 64 ? (uint16_t)(s->lost_q15 - 64) : 0;
}

static void control(struct speed_control *s, const struct speed_settings *settings)
{
    struct room rooms[WHEELS];
    uint32_t forward_q23 = forward_now_q23(s, settings);
    bool is_short = false, has_room = true, both_closed = true;
    int32_t turn_error = 0, turn_room_q8 = 0;
    for (uint8_t number = 0; number < WHEELS; number++) {
        struct room *room = &rooms[number];
        find_room(room, s, settings, forward_q23, number);
        int32_t error = along(room->direction, room->due - room->speed);
        turn_error += number == RIGHT ? error : -error;
        turn_room_q8 += room->most_q8 - room->forward_q8;
        both_closed = both_closed && (room->is_closed || !room->direction);
    }
    int32_t turn_q8 = 0;
    if (both_closed)
        turn_q8 = proportional_q8(&settings->turn, turn_error) + shifted(s->turn_q16, 8);
    for (uint8_t number = 0; number < WHEELS; number++) {
        struct speed_wheel *wheel = &s->wheel[number];
        const struct room *room = &rooms[number];
        int32_t more_q8 = along(room->direction, number == RIGHT ? turn_q8 : -turn_q8);
        is_short = drive_wheel(wheel, settings, room, more_q8) || is_short;
        int32_t roomy_q8 = (int32_t)((uint16_t)room->most_q8 / 256 * (256 / 32 * 31));
        has_room = has_room && (!room->direction || magnitude(wheel->pwm_q8) < roomy_q8);
    }
    if (both_closed && !is_short) {
        int32_t grown = grown_q16(&settings->turn, s->turn_q16, turn_error);
        int32_t most_q16 = turn_room_q8 * 128;      /* half of what both wheels have */
        s->turn_q16 = clamped(grown, -most_q16, most_q16);
    }
    share_the_limit(s, is_short, has_room);
}

static uint16_t silent_ms(const struct speedometer *meter)
{
    return (uint16_t)(meter->silent * (65536ul / STAMPS_PER_MS + 1) >> 16);
}

/* Flags of this period, and whether a wheel is held. */
static bool judge(struct speed_control *s)
{
    bool is_held = false;
    uint8_t flags = s->lost_q15 >= LIMIT_Q15 ? SPEED_AT_LIMIT : 0;
    for (uint8_t number = 0; number < WHEELS; number++) {
        struct speed_wheel *wheel = &s->wheel[number];
        const struct speedometer *meter = &wheel->speedometer;
        int32_t speed = wheel->set_um_s < 0 ? -meter->um_s : meter->um_s;
        if (held_judge(&wheel->held, magnitude(wheel->set_um_s), speed, silent_ms(meter))) {
            flags |= (uint8_t)(SPEED_LEFT_HELD << number);
            is_held = true;
        }
        if (meter->is_overdue && wheel->held.has_turned)
            flags |= (uint8_t)(SPEED_LEFT_OVERDUE << number);
    }
    const uint8_t held = SPEED_LEFT_HELD | SPEED_RIGHT_HELD;
    s->flags = is_held ? flags : (uint8_t)(flags | (s->flags & held));
    return is_held;
}

static void stop_wheel(struct speed_control *s, struct speed_wheel *wheel)
{
    wheel->held = (struct held){ 0 };
    wheel->ramp_um_s = 0;
    wheel->set_um_s = 0;
    wheel->due_um_s = 0;
    wheel->growth_um_s = 0;
    wheel->integral_q16 = 0;
    wheel->pwm_q8 = 0;
    s->turn_q16 = 0;        /* of a turn that is no longer asked for */
}

void speed_on_asked(struct speed_control *s, uint8_t number, int32_t um_s)
{
    struct speed_wheel *wheel = &s->wheel[number];
    if ((wheel->set_um_s > 0 && um_s <= 0) || (wheel->set_um_s < 0 && um_s >= 0))
        stop_wheel(s, wheel);
    if (!s->wheel[LEFT].set_um_s && !s->wheel[RIGHT].set_um_s)
        speed_stop(s);
}

void speed_stop(struct speed_control *s)
{
    for (uint8_t number = 0; number < WHEELS; number++)
        stop_wheel(s, &s->wheel[number]);
    s->lost_q15 = 0;
    s->short_for = 0;
}

void speed_forget_wheels(struct speed_control *s)
{
    for (uint8_t number = 0; number < WHEELS; number++)
        s->wheel[number].speedometer = (struct speedometer){ 0 };
}

bool speed_step(struct speed_control *s, const struct speed_settings *settings, const struct speed_input *in)
{
    smooth_battery(s, in->battery_adc_counts);
    bool all_stand = true, rolls_out = roll_out(s, s->against);
    s->against = 0;
    for (uint8_t number = 0; number < WHEELS; number++) {
        struct speed_wheel *wheel = &s->wheel[number];
        int32_t asked = in->asked_um_s[number];
        uint32_t um_per_tick_q8 = settings->um_per_tick_q8[number];
        if (um_per_tick_q8)
            speedometer_step(&wheel->speedometer, um_per_tick_q8, in->ticks[number], in->stamps[number], in->now);
        speed_on_asked(s, number, asked);
        int32_t um_s = wheel->speedometer.um_s;
        if ((asked > 0 && um_s < 0) || (asked < 0 && um_s > 0))
            s->against = (uint16_t)(s->against + (magnitude(um_s) >> 9));
        wheel->ramp_um_s = ramped(wheel->ramp_um_s, asked, growth_max(wheel, settings->step_um_s, rolls_out));
        int32_t set = smoothed(wheel->set_um_s, wheel->ramp_um_s);
        int32_t growth = magnitude(set) - magnitude(wheel->set_um_s);
        wheel->growth_um_s = growth < 0 ? 0 : growth < UINT16_MAX ? (uint16_t)growth : UINT16_MAX;
        wheel->set_um_s = set;
        wheel->due_um_s = growth < 0 ? set : wheel->due_um_s + shifted((set - wheel->due_um_s) * DUE_Q8, 8);
        all_stand = all_stand && !set;
    }
    bool is_held = judge(s);
    if (!all_stand && !is_held)
        control(s, settings);
    return is_held;
}
