"""What the base board gives its motors to hold speeds: the signs, the bounds, the starts and the stops."""

import math
import random

import pytest

from giraff_schemas.wire import (
    PWM_OVER_BLIND_PERCENT,
    PWM_OVER_PERCENT,
    DriveState,
    Latch,
    SpeedFlag,
    WheelsFrame,
    Wiring,
)
from tests.firmware.bench import ACCELERATION, SpeedBench
from tests.support.robots import BY_SPEED, ROBOT

TELEMETRY_MS = 17  # within which telemetry tells of what has happened
FRAME_MS = 3  # within which a speed frame has come over the line and acted
PERIOD_MS = 10  # of the control
OVERSHOOT = 0.06  # m/s: a tenth of the largest speed
CONTROL = BY_SPEED.speed_control


def feed_forward(speed: float, volts: float = 24.0) -> float:
    """PWM counts that hold a speed, m/s, of a motor as the robot's file expects it."""
    return BY_SPEED.max_level * abs(speed) / ROBOT.max_wheel_speed * BY_SPEED.battery_nominal / volts


@pytest.mark.parametrize("wiring", [Wiring(0), Wiring.SWAP_MOTORS | Wiring.SWAP_ENCODERS, ~Wiring(0)])
def test_a_stop_takes_the_time_of_its_frame_and_no_more(robot: SpeedBench, wiring: Wiring) -> None:
    for offset in range(PERIOD_MS):
        robot.begin(0.5, -0.4, 600, wiring=wiring)
        robot.run(offset)
        robot.send(robot.speed_frame(0.0, 0.0))
        assert robot.stopped_after_ms() <= FRAME_MS
        robot.go(0.0, 0.0, 600)
    assert robot.wheels().latch == Latch.NONE


def test_one_wheel_stops_as_fast_while_the_other_goes_on(robot: SpeedBench) -> None:
    robot.begin(0.5, 0.4)
    robot.send(robot.speed_frame(0.0, 0.4))
    robot.run(FRAME_MS)
    assert robot.duties()[0] == 0
    assert robot.duties()[1] > 20


@pytest.mark.parametrize("offset", range(PERIOD_MS))
def test_a_reversal_gets_nothing_of_what_was_before(robot: SpeedBench, offset: int) -> None:
    """Whenever in the control's period it comes."""
    robot.begin(0.4, -0.4)
    robot.run(offset)
    robot.send(robot.speed_frame(-0.4, 0.4))
    robot.run(FRAME_MS)
    for _ in range(100):
        left, right = robot.duties()
        assert left <= 0 <= right
        robot.run(1)


@pytest.mark.parametrize("asked", [(-0.5, -0.5), (-0.5, 0.3), (0.5, -0.4)])
def test_a_wheel_that_has_turned_round_starts_from_rest(robot: SpeedBench, asked: tuple[float, float]) -> None:
    """Its ramp waits for it. A wheel that goes on waits too, so that the robot keeps to its curve."""
    robot.begin(0.45, 0.3)
    speeds: list[list[float]] = []
    robot.go(*asked, 1500, lambda: speeds.append(list(robot.speed)))
    for wheel, sign in enumerate(math.copysign(1.0, one) for one in asked):
        along = [max(0.0, sign * speed[wheel]) for speed in speeds]
        assert max(now - then for then, now in zip(along, along[100:], strict=False)) < ACCELERATION / 10 + OVERSHOOT
        assert along[-1] == pytest.approx(abs(asked[wheel]), abs=0.02)


@pytest.mark.parametrize("pull", [(-0.2, -0.2), (-0.2, 0.0), (-0.3, -0.3)])
def test_a_wheel_that_is_pulled_the_other_way_is_not_waited_for(robot: SpeedBench, pull: tuple[float, float]) -> None:
    """On a slope, or by a person: it drives, as long as its motors can."""
    robot.pull = list(pull)
    robot.begin(0.5, 0.5)
    assert robot.wheels().latch == Latch.NONE
    assert robot.speed == pytest.approx([0.5, 0.5], abs=0.15)


@pytest.mark.parametrize("seed", range(3))
def test_output_never_has_the_sign_opposite_to_what_is_asked(robot: SpeedBench, seed: int) -> None:
    """Slowing down is coasting, whatever turns the wheels."""
    chance = random.Random(seed)
    robot.begin()
    robot.hands = [lambda _ms: hands[0], lambda _ms: hands[1]]
    for _ in range(60):
        asked = [chance.choice((-1, 0, 1)) * chance.uniform(0.01, 0.5) for _ in range(2)]
        hands = [one * chance.uniform(0.6, 1.6) for one in asked]
        robot.send(robot.speed_frame(*asked))
        robot.run(FRAME_MS)
        for _ in range(chance.randrange(10, 200)):
            robot.run(1)
            for one, duty in zip(asked, robot.duties(), strict=True):
                assert one * duty > 0 or not duty
        if robot.wheels().drive_state == DriveState.HELD:
            robot.go(0.0, 0.0)
        elif robot.wheels().drive_state == DriveState.LATCHED:
            robot.send(robot.estop_frame(engage=0))
            robot.run(TELEMETRY_MS)
            robot.go(0.0, 0.0)


def rising(robot: SpeedBench, left: float, right: float, milliseconds: int) -> list[tuple[float, ...]]:
    """What the motors get in each millisecond from the start on."""
    seen: list[tuple[float, ...]] = []
    robot.go(left, right, milliseconds, lambda: seen.append(robot.duties()))
    return seen


def test_a_start_after_a_stop_is_the_same_as_the_first(robot: SpeedBench) -> None:
    """With the first at rest, too: of weak motors, so that much is gathered."""
    robot.strength = [0.85, 0.95]
    robot.begin()
    robot.go(0.0, 0.0, 100)
    robot.run(-robot.now_ms % 100)
    first = rising(robot, 0.5, 0.3, 600)
    robot.go(0.5, 0.3, 800)
    robot.go(0.0, 0.0, 2000)
    robot.run(-robot.now_ms % 100)
    again = rising(robot, 0.5, 0.3, 600)
    assert first[:50] == again[:50], "before its first edges"
    for at in range(50, 600, 50):
        for wheel in range(2):
            one, other = (sum(duties[wheel] for duties in seen[at : at + 50]) / 50 for seen in (first, again))
            assert one == pytest.approx(other, abs=1.5)


def test_a_reversal_begins_without_what_the_turn_loop_gathered(robot: SpeedBench) -> None:
    """Of unlike motors that is much, and backward it would be on the wrong side."""
    robot.strength = [0.8, 1.0]
    robot.begin(speed_p=0, speed_i=0)
    robot.go(0.3, 0.3, 3000)
    gathered = robot.duties()[0] - robot.duties()[1]
    robot.go(-0.3, -0.3, 5)
    differences: list[float] = []
    robot.go(-0.3, -0.3, 1000, lambda: differences.append(robot.duties()[0] - robot.duties()[1]))
    assert gathered > 5
    assert max(differences) < gathered / 2


@pytest.mark.parametrize("asked", [(0.5, 0.3), (-0.4, 0.4)])
@pytest.mark.parametrize("pause", ["zero", "other wheel", "reversal"])
def test_however_short_a_stop_was_the_next_start_begins_from_rest(
    robot: SpeedBench, asked: tuple[float, float], pause: str
) -> None:
    """A zero and a start within one period of the control. A speed that is kept comes back within five periods."""
    left, right = asked
    stops = {"zero": (0.0, 0.0), "other wheel": (0.0, right), "reversal": (-left, -right)}
    robot.begin(left, right)
    for offset in range(PERIOD_MS):
        robot.go(left, right, 600)
        robot.run(offset)
        robot.send(robot.speed_frame(*stops[pause]))
        robot.run(FRAME_MS - 1)
        robot.send(robot.speed_frame(left, right))
        for _ in range(5 * PERIOD_MS):
            robot.run(1)
            assert abs(robot.duties()[0]) < feed_forward(left) / 2


def test_what_is_asked_grows_by_the_sessions_acceleration_and_falls_at_once(robot: SpeedBench) -> None:
    """Told by what the motors get: none turns, and each gets plain feed-forward."""
    robot.begin(motor_ms=0, stall_pwm=110, dead_pwm=0)
    robot.hands = [lambda _ms: 0.0, lambda _ms: 0.0]
    seen = rising(robot, 0.4, 0.2, 400)
    for millisecond, (left, right) in enumerate(seen):
        most = ACCELERATION * (millisecond + PERIOD_MS) / 1000
        assert left <= feed_forward(min(0.4, most)) + 1
        assert right <= feed_forward(min(0.2, most)) + 1
    assert sum(left for left, _ in seen[-20:]) / 20 == pytest.approx(feed_forward(0.4), rel=0.03)
    robot.go(0.1, 0.2, 40)
    assert robot.duties()[0] <= feed_forward(0.1) + 1


def mean_duties(robot: SpeedBench, left: float, right: float, milliseconds: int) -> tuple[float, float]:
    seen = rising(robot, left, right, milliseconds)
    return sum(one for one, _ in seen) / len(seen), sum(one for _, one in seen) / len(seen)


@pytest.mark.parametrize("volts", [24.0, 20.0, 28.0])
@pytest.mark.parametrize("blind", [False, True])
def test_pwm_is_never_much_more_than_feed_forward(robot: SpeedBench, volts: float, blind: bool) -> None:
    """Of wheels that something slows down, as long as it pushes no harder than that."""
    robot.volts(volts)
    robot.run(100)
    robot.begin(**({"nominal_adc_counts": 0} if blind else {}))
    robot.hands = [lambda ms: min(0.18, ms / 5000), lambda ms: -min(0.18, ms / 5000)]
    robot.go(0.3, -0.3, 1500)
    left, right = mean_duties(robot, 0.3, -0.3, 500)
    most = feed_forward(0.3, 24.0 if blind else volts) + CONTROL.dead_pwm
    most *= 1 + (PWM_OVER_BLIND_PERCENT if blind else PWM_OVER_PERCENT) / 100
    assert robot.wheels().drive_state == DriveState.ACTIVE
    assert left == pytest.approx(most, rel=0.01)
    assert right == pytest.approx(-most, rel=0.01)


def test_pwm_is_never_more_than_the_most_a_session_allows(robot: SpeedBench) -> None:
    robot.begin(pwm_max=60)
    robot.hands = [lambda ms: min(0.4, ms / 5000), lambda ms: min(0.4, ms / 5000)]
    for motor in robot.model.motor:
        motor.drive_peak = 0
    robot.go(0.6, 0.6, 2500)
    assert robot.model.motor[0].drive_peak == robot.model.motor[1].drive_peak == 60


@pytest.mark.parametrize("pin_volts", [0.0, 1.0, 5.0])
def test_a_battery_that_cannot_be_is_an_unknown_one(robot: SpeedBench, pin_volts: float) -> None:
    """A divider whose wire is off must not make the motors strong."""
    robot.model.battery_volts = pin_volts
    robot.run(100)
    robot.begin(nominal_adc_counts=650)
    robot.hands = [lambda _ms: 0.0, lambda _ms: 0.0]
    robot.go(0.3, 0.3, 350)
    assert mean_duties(robot, 0.3, 0.3, 100)[0] == pytest.approx(feed_forward(0.3), rel=0.03)


def test_a_wheel_that_stands_never_gets_more_than_stall_pwm(robot: SpeedBench) -> None:
    robot.begin()
    robot.hands = [lambda _ms: 0.0, lambda _ms: 0.0]
    robot.go(0.6, -0.6, 700)
    assert robot.wheels().latch == Latch.LEFT_STUCK
    assert robot.model.motor[0].drive_peak == robot.model.motor[1].drive_peak == CONTROL.stall_pwm


@pytest.mark.parametrize("each", [1, 3, 7])
def test_nor_does_one_that_trembles_on_an_edge(robot: SpeedBench, each: int) -> None:
    """Its edges come and go, and tell of no way."""
    robot.begin()
    amplitude = 1.5 / ROBOT.ticks_per_metre / 2 * 1000
    robot.hands = [lambda ms: (amplitude if ms // each % 2 else -amplitude) / each] * 2
    robot.go(0.6, 0.6, 700)
    assert robot.wheels().latch in (Latch.LEFT_STUCK, Latch.RIGHT_STUCK)
    assert robot.model.motor[0].drive_peak <= CONTROL.stall_pwm


def test_at_its_limit_the_curve_stays_and_full_speed_comes_back_with_the_battery(robot: SpeedBench) -> None:
    robot.strength = [0.75, 0.95]
    robot.volts(27.0)
    robot.begin(0.5, 0.4, pwm_max=75)
    robot.volts(20.0)
    robot.go(0.5, 0.4, 4000)
    assert robot.wheels().speed_flags & SpeedFlag.AT_LIMIT
    assert robot.speed[0] < 0.47
    assert robot.speed[0] / robot.speed[1] == pytest.approx(0.5 / 0.4, rel=0.03)
    robot.go(0.0, 0.0, 100)
    robot.go(0.5, 0.4, 100)
    assert not robot.wheels().speed_flags & SpeedFlag.AT_LIMIT, "a start after a stop begins anew"
    robot.go(0.5, 0.4, 3000)
    assert robot.wheels().speed_flags & SpeedFlag.AT_LIMIT
    robot.volts(27.0)
    robot.go(0.5, 0.4, 4000)
    assert not robot.wheels().speed_flags & SpeedFlag.AT_LIMIT
    assert robot.speed == [pytest.approx(0.5, rel=0.03), pytest.approx(0.4, rel=0.03)]


def test_a_wheel_that_is_let_go_does_not_swing_the_robot_back(robot: SpeedBench) -> None:
    """The turn loop does not integrate while a wheel is held back. If it did, the robot would swing back by 2.8°."""
    robot.strength = [0.85, 1.0]
    robot.begin(0.5, 0.5)
    robot.hands[1] = lambda _ms: 0.3
    robot.go(0.5, 0.5, 500)
    robot.hands[1] = None
    yaws = [0.0]
    track = ROBOT.track_width
    robot.go(0.5, 0.5, 600, lambda: yaws.append(yaws[-1] + (robot.speed[1] - robot.speed[0]) / track / 1000))
    assert math.degrees(yaws[-1] - min(yaws)) <= 0.5


def test_other_encoders_are_no_speed(robot: SpeedBench) -> None:
    """The counts of a session that is wired another way are far from what they were."""
    robot.begin(0.3, 0.2)
    robot.forget()
    robot.run(TELEMETRY_MS)
    robot.configure(session=8, wiring=Wiring.SWAP_ENCODERS | Wiring.INVERT_LEFT_ENCODER)
    robot.run(200)
    assert all(max(abs(told.left_um_s), abs(told.right_um_s)) < 320_000 for told in robot.all(WheelsFrame))


@pytest.mark.parametrize("speed", [0.1, -0.3])
@pytest.mark.parametrize("begins", ["from rest", "while it goes"])
def test_a_wheel_that_turns_against_what_is_asked_is_latched_and_not_pushed_the_harder(
    robot: SpeedBench, speed: float, begins: str
) -> None:
    """An encoder that is wired the other way: the loop would run away."""
    robot.begin(*((0.0, 0.0) if begins == "from rest" else (speed, speed)))
    robot.hands = [lambda _ms: -speed, None]
    for motor in robot.model.motor:
        motor.drive_peak = 0
    robot.go(speed, speed, 20)
    robot.model.motor[0].drive_peak = 0
    robot.go(speed, speed, 380)
    if begins == "from rest":
        assert robot.wheels().latch == Latch.LEFT_OPPOSITE
    else:
        assert robot.wheels().drive_state == DriveState.HELD
    lead = ACCELERATION * CONTROL.motor_time
    assert robot.model.motor[0].drive_peak <= feed_forward(abs(speed) + lead) + 1


def test_in_a_session_of_levels_speeds_are_told_and_nothing_else_is_done(robot: SpeedBench) -> None:
    robot.configure(level_max=70, speed_max_um_s=0)
    robot.drive(0, 0)
    robot.drive(35, -35, 1500)
    assert robot.duties() == (35, -35)
    assert robot.last(WheelsFrame).left_um_s == pytest.approx(300_000, rel=0.02)
    assert robot.last(WheelsFrame).right_um_s == pytest.approx(-300_000, rel=0.02)
    assert robot.last(WheelsFrame).speed_flags == 0
