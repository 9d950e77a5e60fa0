#include "control.h"
#include "inertial.h"
#include "kalman.h"
#include "posture.h"
#include "reference.h"
#include "torque.h"
#include "watch.h"
#include "wheel_speed.h"

static struct {
    struct model model;
    bool is_second;                     /* of two periods */
    struct inertial inertial;
    struct kalman kalman;
    struct wheel_speed wheels;
    struct watch watch;
    struct posture posture;
    struct reference reference;
    struct torque torque;
    struct balance_state state;
} balance;

void balance_start(void)
{
    balance.model = (struct model){ .is_prototype = true };
    balance.wheels = (struct wheel_speed){ 0 };
    balance.watch = (struct watch){ 0 };
    balance.posture = (struct posture){ .posture = BALANCE_OFF, .cause = CAUSE_NONE };
    balance.reference = (struct reference){ 0 };
    balance.torque = (struct torque){ 0 };
    balance.state = (struct balance_state){ 0 };
    inertial_start(&balance.inertial);
    kalman_start(&balance.kalman);
}

void balance_configure(const struct balance_settings *settings)
{
    float per_gravity = 1.0f / settings->gravity;
    balance.model = (struct model){
        .settings = *settings,
        .is_prototype = settings->k3 == 0.0f && settings->k4 == 0.0f,
        .per_radius = 1.0f / settings->radius,
        .half_radius = settings->radius * 0.5f,
        .half_track = settings->track * 0.5f,
        .turn_per_rad = settings->radius / settings->track,
        .lean_per_acceleration = settings->momentum_per_speed * per_gravity,
        .acceleration_per_lean = settings->gravity / settings->momentum_per_speed,
        .lean_per_speed = settings->momentum_per_speed * per_gravity / SLOW_PERIOD,
        .lean_per_rate = settings->momentum_per_rate * per_gravity / SLOW_PERIOD,
        .volts_per_torque = settings->motor_ohm / settings->motor_constant,
        .acceleration_step = settings->acceleration * PERIOD,
        .braking_step = settings->braking * PERIOD,
    };
    reference_halt(&balance.reference);
}

const struct balance_state *balance_state(void)
{
    return &balance.state;
}

static void tell(void)
{
    struct balance_state *s = &balance.state;
    s->posture = balance.posture.posture;
    s->cause = balance.posture.cause;
    s->flags = (balance.posture.posture == BALANCE_OFF && balance.posture.is_calm ? BALANCE_UPRIGHT : 0)
               | (balance.reference.is_held ? BALANCE_HELD : 0) | (balance.torque.is_at_limit ? BALANCE_AT_LIMIT : 0);
    s->lean = balance.kalman.lean;
    s->rate = balance.kalman.rate;
    s->accelerometer = balance.kalman.measured;
    s->trim = balance.reference.trim;
    s->speed = balance.wheels.axle;
    s->turn = balance.wheels.turn;
    s->torque = balance.torque.both;
    for (uint8_t k = 0; k < WHEELS; k++) {
        s->command[k] = balance.torque.command[k];
    }
}

void balance_step(const struct balance_readings *readings, const struct balance_order *order)
{
    const struct model *model = &balance.model;
    bool is_off = balance.posture.posture == BALANCE_OFF;
    bool has_accelerometer = !(balance.watch.kept & FAULT(CAUSE_ACCELEROMETER));
    const bool lost[WHEELS] = { balance.watch.kept & FAULT(CAUSE_LEFT_ENCODER),
                                balance.watch.kept & FAULT(CAUSE_RIGHT_ENCODER) };

    balance.is_second = !balance.is_second;
    inertial_step(&balance.inertial, readings);
    wheel_speed_count(&balance.wheels, model, readings->counts, lost);
    kalman_step(&balance.kalman, &(struct kalman_input){
        .rate = balance.inertial.rate,
        .forward = balance.inertial.forward,
        .up = balance.inertial.up,
        /* By hand it can be lifted and its wheels turned. */
        .axle = is_off ? 0.0f : wheel_speed_acceleration(&balance.wheels, model, &balance.kalman),
        .corrects = has_accelerometer && !balance.is_second,
    });
    wheel_speed_fuse(&balance.wheels, model, &balance.kalman, balance.inertial.forward, has_accelerometer);
    watch_step(&balance.watch, &(struct watch_input){
        .readings = readings,
        .model = model,
        .inertial = &balance.inertial,
        .kalman = &balance.kalman,
        .wheels = &balance.wheels,
        .command = balance.torque.command,
        .is_off = is_off,
        .sways = balance.reference.sways,
        .is_second = balance.is_second,
        .leans_over = balance.posture.leans_over,
    });
    bool stood_up = posture_step(&balance.posture, &(struct posture_input){
        .order = order,
        .kalman = &balance.kalman,
        .cord_pulled = readings->cord_pulled,
        .faults = balance.watch.faults,
        .speed = balance.wheels.axle,
        .trim = balance.reference.trim,
    });
    if (stood_up) {
        reference_start(&balance.reference);
        balance.wheels.axle = 0.0f;
    }
    reference_step(&balance.reference, &(struct reference_input){
        .model = model,
        .order = order,
        .kalman = &balance.kalman,
        .wheels = &balance.wheels,
        .stands = balance.posture.posture == BALANCE_STANDS,
        .since = balance.posture.since,
        .is_second = balance.is_second,
    });
    torque_step(&balance.torque, &(struct torque_input){
        .model = model,
        .kalman = &balance.kalman,
        .wheels = &balance.wheels,
        .reference = &balance.reference,
        .posture = &balance.posture,
        .volts = balance.inertial.volts,
        .has_encoders = !lost[LEFT] && !lost[RIGHT] && !model->is_prototype,
    });
    tell();
}
