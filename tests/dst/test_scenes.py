"""Scenes that once broke a rule, found by seeds: the hand, the fault and the times that it takes, and no others."""

import math
from typing import Final

import msgspec
import pytest

from giraff_core.senses import Bumper
from giraff_sim.dst.faults.robot import bumper
from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import Outcome, Scenario, play
from giraff_sim.world.bno055 import GRAVITY, Bno055Fault, Vector
from giraff_sim.world.hand import LEVEL, ScriptedHand
from tests.dst.courses import fail_tilt_sensor
from tests.dst.stage import SET_OFF, SETTINGS, at, hall, level, rules, stage
from tests.support.robots import BUMPED


def _tilted(forward: float, left: float = 0.0) -> Vector:
    """Return what the joystick's sensor reads, m/s², of which two are given."""
    return forward, left, math.sqrt(GRAVITY**2 - forward**2 - left**2)


def _reverse_into_a_turn() -> Outcome:
    """Drive forward, then backward and to the right: one wheel reverses at full speed."""
    hand = ScriptedHand([0.0, SET_OFF, 3.2], [LEVEL, _tilted(6.0), _tilted(-3.0, -6.0)])
    return stage(hand=hand, seconds=3.6)


def _let_go_while_frozen() -> Outcome:
    """Let the button go, level, while the sensor still repeats a tilt. Later hold that tilt, and lean on from it."""
    moments = [(0.0, LEVEL), (2.6, _tilted(4.0)), (3.2, LEVEL), (4.4, _tilted(4.0)), (5.4, _tilted(7.5))]
    hand = ScriptedHand([moment for moment, _ in moments], [tilt for _, tilt in moments])
    frozen = at(3.0, fail_tilt_sensor(Bno055Fault.FROZEN), 1.2)
    return stage(frozen, hand=hand, seconds=6.0, presses=((2.0, 4.0),))


SCENES: Final = {"(g) reverse into a turn": _reverse_into_a_turn, "(c) let go while frozen": _let_go_while_frozen}


@pytest.mark.parametrize("scene", SCENES)
def test_no_rule_is_broken(scene: str) -> None:
    assert rules(SCENES[scene]()) == set()


def test_the_wire_of_a_bumper_is_cut_where_the_robot_has_one() -> None:
    assert any(each.kind.begin is bumper for seed in range(40) for each in draw(seed).faults)
    bumped = msgspec.structs.replace(SETTINGS.robot, sensors=SETTINGS.robot.sensors | BUMPED.of(Bumper))
    for robot, times in ((SETTINGS.robot, 0), (bumped, 1)):
        scenario = Scenario(1, hall(), level(), 0.1, (at(0.04, bumper, 0.04),))
        outcome = play(scenario, msgspec.structs.replace(SETTINGS, robot=robot))
        assert outcome.counts.get("fault: staged", 0) == times
