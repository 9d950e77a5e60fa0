"""What a script reads: which sensors there are, what of them is a fault, and which way is blocked."""

import math
from typing import Any

import msgspec
import pytest

from giraff_client import Bump, RobotError, SilentError
from giraff_client.reading import Heard, States, blockage, has_heard_each_sensor, ranges_of, require_finite
from giraff_core.latest import LatestSamples, is_fresh
from giraff_schemas.messages import Battery, Direction, GuardState, Sample
from giraff_schemas.topics import BATTERY, ESTOP, GUARD, ODOM, RANGE, SampleT, Topic
from tests.unit.cli import samples

NOW = 100.0
DIRECTIONS: tuple[Direction, ...] = ("forward", "backward", "turn_left", "turn_right")


def heard(*sensors: str, guard: bool = True, ago: float = 0.1) -> dict[str, tuple[Sample, float]]:
    """A robot of three sensors of which only these were heard, `ago` s before now."""
    found: dict[str, tuple[Sample, float]] = {
        f"range/{sensor}": (samples.reading(sensor, 1.2), NOW - ago) for sensor in sensors
    }
    if guard:
        found[GUARD.key] = samples.guard(samples.verdict()), NOW
    return found


def test_each_sensor_of_the_robot_is_waited_for() -> None:
    assert not has_heard_each_sensor(RANGE, heard("front_left", "rear"))
    assert has_heard_each_sensor(RANGE, heard(*samples.SENSORS))
    assert not has_heard_each_sensor(RANGE, heard(*samples.SENSORS, guard=False)), "nobody has told which there are"


def test_one_that_was_never_heard_is_a_fault_and_never_left_out() -> None:
    ranges = ranges_of(heard("front_left", "rear"), NOW)
    assert tuple(ranges) == samples.SENSORS
    assert ranges["rear"].range == 1.2
    missing = ranges["front_right"]
    assert (missing.sensor, missing.state, missing.range) == ("front_right", "fault", None)
    assert str(missing.reason).startswith("range/front_right was never heard; check that giraff_ranger runs")


def test_one_that_has_fallen_silent_is_a_fault() -> None:
    assert ranges_of(heard("rear", ago=1.0), NOW)["rear"].state == "echo"
    silent = ranges_of(heard("rear", ago=1.1), NOW)["rear"]
    assert (silent.state, silent.range, silent.echo_us) == ("fault", None, 0)
    assert str(silent.reason).startswith("range/rear is silent for 1.1 s; check giraff_ranger")


def test_without_the_guard_there_are_those_that_are_heard() -> None:
    assert set(ranges_of(heard("front_left", "rear", guard=False), NOW)) == {"front_left", "rear"}
    assert ranges_of(heard(guard=False), NOW) == {}


class Script(States):
    """A script that has heard this of its robot."""

    def __init__(self, state: GuardState, **bumpers: tuple[bool, float]) -> None:
        """`bumpers`: by name, whether something pushes it, and how long ago it said so, s."""
        self.heard: dict[str, tuple[Sample, float]] = {
            f"bumper/{name}": (samples.bump(name, pressed=pressed), NOW - ago)
            for name, (pressed, ago) in bumpers.items()
        }
        self.heard[GUARD.key] = state, NOW

    def _hear_each(self, topic: Topic[Any]) -> tuple[Heard, float]:
        del topic
        return self.heard, NOW

    def _silence(self, text: str) -> RobotError:
        return SilentError(text)

    def _fresh(self, topic: Topic[SampleT], remedy: str) -> SampleT:
        del remedy
        sample = self.heard[topic.key][0]
        assert isinstance(sample, topic.schema)
        return sample


def test_what_bumpers_say_is_read_and_none_is_left_out() -> None:
    free, both = samples.guard(samples.verdict()), samples.with_bumpers(samples.verdict())
    assert Script(free).sensed(Bump) == {}, "it has none"
    heard = Script(both, back=(False, 1.0), front=(True, 0.0)).sensed(Bump)
    assert {name: bump.pressed for name, bump in heard.items()} == {"front": True, "back": False}
    with pytest.raises(SilentError, match=r"^bumper/back was never heard; check that giraff_ranger runs, .*wires$"):
        Script(both, front=(True, 0.0)).sensed(Bump)
    with pytest.raises(SilentError, match=r"^bumper/back is silent for 1\.1 s; check giraff_ranger and its board$"):
        Script(both, front=(False, 0.0), back=(False, 1.1)).sensed(Bump)
    with pytest.raises(ValueError, match=r"sensed\(Battery\): .*; take one of Range, Bump"):
        Script(both).sensed(Battery)


def test_one_lost_sample_makes_nothing_silent() -> None:
    for topic in (ODOM, GUARD, BATTERY, ESTOP):
        assert is_fresh(topic, 2 / topic.rate_hz)
        assert not is_fresh(topic, 1.6)
    assert not is_fresh(GUARD, 1.1)
    latest = LatestSamples()  # whatever shows a robot goes by the same
    latest.add(Battery(voltage=24.0), 0.0)
    assert [each.fresh for at_ns in (1.4e9, 1.6e9) for each in latest.all(BATTERY, round(at_ns))] == [True, False]


def blocked(*directions: Direction) -> GuardState:
    wall = samples.verdict(0.0, "blocked", "front_left", "front_left sees something at 0.40 m", "turn left or back up")
    return msgspec.structs.replace(samples.guard(samples.verdict()), **dict.fromkeys(directions, wall))


@pytest.mark.parametrize(
    ("twist", "direction"),
    [
        ((0.2, 0.0), "forward"),
        ((-0.2, 0.0), "backward"),
        ((0.0, 0.3), "turn_left"),
        ((0.0, -0.3), "turn_right"),
    ],
)
def test_a_way_is_blocked_that_the_guard_blocks_and_no_other(twist: tuple[float, float], direction: Direction) -> None:
    error = blockage(blocked(direction), *twist)
    assert error is not None
    assert (error.direction, error.sensor, error.remedy) == (direction, "front_left", "turn left or back up")
    assert str(error) == f"{direction} blocked: front_left sees something at 0.40 m; turn left or back up"
    others: tuple[Direction, ...] = tuple(other for other in DIRECTIONS if other != direction)
    assert blockage(blocked(*others), *twist) is None
    assert blockage(blocked(*DIRECTIONS), 0.0, 0.0) is None, "who stands asks for nothing"


@pytest.mark.parametrize("direction", ["forward", "turn_left"])
def test_a_curve_asks_for_both(direction: Direction) -> None:
    error = blockage(blocked(direction), 0.2, 0.3)
    assert error is not None
    assert error.direction == direction


def test_a_way_that_is_only_slow_is_not_blocked() -> None:
    for clearance in ("slow", "creep"):
        assert blockage(samples.guard(samples.verdict(0.03, clearance)), 0.2, 0.0) is None


@pytest.mark.parametrize("twist", [(math.nan, 0.0), (0.0, math.inf)])
def test_what_is_no_number_is_no_twist(twist: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"check_way\(.*finite numbers, m/s and rad/s"):
        require_finite("check_way", "m/s and rad/s", *twist)
