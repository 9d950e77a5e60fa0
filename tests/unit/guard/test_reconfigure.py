"""What is tightened while the robot drives counts at once, in each part that judges by it."""

import msgspec
import pytest

from giraff_guard.config import GuardConfig
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.guard.rig import CONFIG, FAR, ROBOT, Rig
from tests.unit.guard.senses import Senses, opened


def tightened(senses: Senses, **changes: float) -> None:
    senses.live.replace(msgspec.structs.replace(CONFIG, **changes))


@pytest.mark.parametrize("way", ["forward", "backward"])
def test_a_larger_margin_blocks_either_way(way: str) -> None:
    senses = opened(distance=0.8)
    assert senses.allowed(way) > 0.1
    tightened(senses, margin=0.8)
    assert senses.verdict(way).clearance == "blocked"


@pytest.mark.parametrize("sensor", ROBOT.sensors)
def test_a_reading_older_than_the_new_budget_blinds_whichever_sensor_it_is_of(senses: Senses, sensor: str) -> None:
    senses.wait(0.3)
    senses.hear(FAR, *(name for name in ROBOT.sensors if name != sensor))
    assert set(senses.troubles().values()) == {NO_TROUBLE}
    tightened(senses, range_budget=0.2)
    sensors = senses.troubles()
    assert "stale" in str(sensors.pop(sensor))
    assert set(sensors.values()) == {NO_TROUBLE}


def test_a_shorter_way_makes_a_repeated_echo_frozen(senses: Senses) -> None:
    tightened(senses, frozen_travel=0.05)
    senses.linear = 0.3
    senses.cycle(FAR, cycles=2)
    assert all("frozen" in str(reason) for reason in senses.troubles().values())


def test_wheels_older_than_the_new_budget_are_not_heard(senses: Senses) -> None:
    senses.robot_ns += 300_000_000
    senses.judge()
    assert senses.obstacles._motion.heard
    tightened(senses, range_budget=0.2)
    senses.judge()
    assert not senses.obstacles._motion.heard


def test_a_larger_margin_around_what_is_remembered_brings_it_nearer(senses: Senses) -> None:
    senses.cycle({"front_left": 0.5}, cycles=3)
    senses.linear = 0.3
    senses.cycle(None, cycles=4)
    senses.linear = 0.0
    senses.cycle(None, cycles=3)
    before = senses.allowed()
    assert before > 0.0
    tightened(senses, memory_margin=0.2)
    assert senses.allowed() < before


def test_a_slower_creep_holds_for_turning_before_an_obstacle(senses: Senses) -> None:
    senses.hear(0.3)
    assert senses.passes(0.6, 1.0) == (0.0, 0.35)
    tightened(senses, creep_angular=0.2)
    assert senses.passes(0.6, 1.0) == (0.0, 0.2)


def rig(config: GuardConfig = CONFIG) -> Rig:
    """A guard that lets its operator drive."""
    rig = Rig(config=config)
    rig.look(1.5)
    assert rig.passes(0.6) == (0.6, 0.0)
    return rig


def test_the_policy_hands_it_to_the_obstacles() -> None:
    guarded = rig()
    guarded.live.replace(msgspec.structs.replace(CONFIG, margin=1.9))
    assert guarded.passes(0.6) == (0.0, 0.0)


def test_the_policy_hands_it_to_the_authority() -> None:
    guarded = rig()
    guarded.ask(0.6, age=0.3)
    assert guarded.decide()[0].linear_x == 0.6
    guarded.live.replace(msgspec.structs.replace(CONFIG, operator_budget=0.2))
    command, _ = guarded.decide()
    assert command.linear_x == 0.0
    assert "no fresh command" in str(command.reason)


def test_what_is_tightened_outlasts_a_new_epoch() -> None:
    """Everything is begun anew then."""
    senses = opened(distance=0.8)
    tightened(senses, margin=0.8)
    senses.obstacles.forget()
    senses.cycle(0.8, cycles=8)
    for way in ("forward", "backward"):
        assert senses.verdict(way).clearance == "blocked"


def test_a_shorter_trust_in_silence(senses: Senses) -> None:
    senses.cycle(None, cycles=30)
    assert senses.verdict().clearance == "free"
    tightened(senses, trust_full_time=1.0, trust_end_time=3.0)
    assert senses.allowed() == pytest.approx(CONFIG.untrusted_speed)


def test_what_fell_silent_may_stand_farther_beside_its_spot(senses: Senses) -> None:
    senses.cycle({"front_left": 0.5}, cycles=3)
    senses.angular = -1.0
    senses.cycle(None, cycles=8)
    senses.angular = 0.0
    tightened(senses, silent_beside=0.01)
    assert "beside" not in str(senses.verdict().reason)
    tightened(senses, silent_beside=0.6)
    assert "beside" in str(senses.verdict().reason)
