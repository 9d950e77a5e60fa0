"""The table `[guard]`: what it takes, and what it refuses by name."""

import math
from pathlib import Path

import msgspec
import pytest

from giraff_core.senses import HC_SR04
from giraff_guard.config import GuardConfig
from giraff_node.config.robot_file import ConfigError, load

NUMBERS = [name for name in GuardConfig.__struct_fields__ if name != "priorities"]
MAY_BE_ZERO = ("run_on", "room_behind")


@pytest.mark.parametrize("field", NUMBERS)
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_number_that_makes_no_sense_is_refused_by_name(field: str, value: float) -> None:
    if value == 0.0 and field in MAY_BE_ZERO:
        value = -0.01
    with pytest.raises(msgspec.ValidationError, match=field):
        msgspec.convert({field: value}, GuardConfig)


def test_what_is_not_measured_is_unset() -> None:
    assert GuardConfig().deceleration is None


def test_priorities_are_a_table_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text("[guard.priorities]\ncarer = 2\nchild = -1\n")
    assert load("guard", GuardConfig, {"GIRAFF_CONFIG": str(path)}).priorities == {"carer": 2, "child": -1}
    path.write_text('[guard.priorities]\ncarer = "first"\n')
    with pytest.raises(ConfigError, match="priorities"):
        load("guard", GuardConfig, {"GIRAFF_CONFIG": str(path)})


def test_what_a_robot_file_leaves_out_is_what_safety_was_reckoned_with() -> None:
    """Each stands in the figures of docs/safety.md: to change one is to measure them again."""
    default = GuardConfig()
    assert (default.margin, default.release, default.reaction_time, default.deceleration) == (0.25, 0.05, 0.10, None)
    assert (default.range_budget, default.operator_budget) == (0.4, 0.4)
    assert (default.operator_release, default.fault_release, default.idle_release) == (1.0, 2.0, 30.0)
    assert (default.publisher_timeout, default.priorities) == (0.5, {"motion": -1, "demo": -2})
    assert (default.creep_linear, default.creep_angular, default.min_speed, default.recovery_step) == (
        0.10,
        0.35,
        0.03,
        0.12,
    )
    assert (default.reach, default.touch_distance, default.frozen_travel) == (10.0, 0.10, 0.20)
    assert HC_SR04.reach == 4.0
    assert [math.degrees(angle) for angle in (HC_SR04.half_cone, HC_SR04.incidence)] == pytest.approx([7.5, 25.0])
    assert (default.range_tolerance, default.person_speed) == (0.10, 1.0)
    assert (default.memory_range, default.memory_time, default.memory_travel) == (1.6, 20.0, 2.0)
    assert (default.memory_margin, default.memory_block) == (0.05, 8.0)
    assert (default.trust_full_time, default.trust_full_travel, default.trust_full_turn) == (10.0, 1.2, 0.5)
    assert (default.trust_end_time, default.trust_end_travel, default.untrusted_speed) == (20.0, 2.0, 0.145)
    assert (default.silent_range, default.silent_time, default.silent_block) == (2.2, 20.0, 1.0)
    assert (default.silent_radius, default.silent_beside) == (0.10, 0.45)


@pytest.mark.parametrize("fields", [{"trust_full_time": 20.0}, {"trust_end_travel": 1.2}, {"trust_full_travel": 3.0}])
def test_a_trust_that_fades_before_it_ends_is_refused(fields: dict[str, float]) -> None:
    with pytest.raises(
        msgspec.ValidationError, match="trust_full_time < trust_end_time, trust_full_travel < trust_end_travel"
    ):
        msgspec.convert(fields, GuardConfig)


def test_a_speed_towards_the_unproved_that_is_a_stop_is_refused() -> None:
    with pytest.raises(msgspec.ValidationError, match="untrusted_speed >= min_speed"):
        msgspec.convert({"untrusted_speed": 0.02}, GuardConfig)
