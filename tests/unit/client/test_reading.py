"""What a script reads: which sensors there are, what of them is a fault, and which way is blocked."""

from __future__ import annotations

import math

import pytest

from giraff_client.reading import has_heard_each_sensor, is_fresh, ranges_of, require_finite
from giraff_schemas.messages import Sample
from giraff_schemas.topics import BATTERY, ESTOP, GUARD, ODOM
from tests.unit.cli import samples

NOW = 100.0


def heard(*sensors: str, guard: bool = True, ago: float = 0.1) -> dict[str, tuple[Sample, float]]:
    """A robot of three sensors of which only these were heard, `ago` s before now."""
    found: dict[str, tuple[Sample, float]] = {
        f"range/{sensor}": (samples.reading(sensor, 1.2), NOW - ago) for sensor in sensors
    }
    if guard:
        found[GUARD.key] = samples.guard(samples.verdict()), NOW
    return found


def test_each_sensor_of_the_robot_is_waited_for() -> None:
    assert not has_heard_each_sensor(heard("front_left", "rear"))
    assert has_heard_each_sensor(heard(*samples.SENSORS))
    assert not has_heard_each_sensor(heard(*samples.SENSORS, guard=False)), "nobody has told which there are"


def test_one_that_was_never_heard_is_a_fault_and_never_left_out() -> None:
    ranges = ranges_of(heard("front_left", "rear"), NOW)
    assert tuple(ranges) == samples.SENSORS
    assert ranges["rear"].range == 1.2
    missing = ranges["front_right"]
    assert (missing.sensor, missing.state, missing.range) == ("front_right", "fault", None)
    assert missing.reason.startswith("range/front_right was never heard; check that giraff_ranger runs")


def test_one_that_has_fallen_silent_is_a_fault() -> None:
    assert ranges_of(heard("rear", ago=1.0), NOW)["rear"].state == "echo"
    silent = ranges_of(heard("rear", ago=1.1), NOW)["rear"]
    assert (silent.state, silent.range, silent.echo_us) == ("fault", None, 0)
    assert silent.reason.startswith("range/rear is silent for 1.1 s; check giraff_ranger")


def test_without_the_guard_there_are_those_that_are_heard() -> None:
    assert set(ranges_of(heard("front_left", "rear", guard=False), NOW)) == {"front_left", "rear"}
    assert ranges_of(heard(guard=False), NOW) == {}


def test_one_lost_sample_makes_nothing_silent() -> None:
    for topic in (ODOM, GUARD, BATTERY, ESTOP):
        assert is_fresh(topic, 2 / topic.rate_hz)
        assert not is_fresh(topic, 1.6)
    assert not is_fresh(GUARD, 1.1)


@pytest.mark.parametrize("twist", [(math.nan, 0.0), (0.0, math.inf)])
def test_what_is_no_number_is_no_twist(twist: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"check_way\(.*finite numbers, m/s and rad/s"):
        require_finite("check_way", *twist)
