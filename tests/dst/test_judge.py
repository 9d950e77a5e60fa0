"""The judge can find each invariant violated, and finds none where nothing is wrong.

Where the fault alone is staged here, the same fault of a sound robot is in test_stops, test_doubles or test_replays.
"""

from collections.abc import Callable
from random import Random
from types import SimpleNamespace
from typing import cast, get_args

import msgspec
import pytest

from giraff_schemas.boards import BaseBoardName
from giraff_schemas.requests import EStopReset
from giraff_sim.bodies.registry import judge_of, world_of
from giraff_sim.bodies.wheels.body import RIGHT, WheelsBody
from giraff_sim.bodies.wheels.pins import Rises
from giraff_sim.config import SimConfig
from giraff_sim.dst.faults.robot import encoder
from giraff_sim.dst.judging.clearance import ClearanceCheck
from giraff_sim.dst.judging.stops import BEYOND_US, ROBOT_US, Stop, Stops
from giraff_sim.dst.simulated_run import SimulatedRun
from giraff_sim.truth import EXACT
from giraff_sim.world.body import BoundedMotion
from giraff_sim.world.hand import LEVEL
from tests.dst import sabotage
from tests.dst.courses import (
    cut,
    deafen,
    engage,
    engage_anew,
    hang_disk,
    kill,
    replay,
    reset_board,
    stop,
    touch_sensors,
    typing,
    typing_a_stop,
    unplug,
)
from tests.dst.sabotage import broken
from tests.dst.stage import BACKWARD, FORWARD, LEFT, SETTINGS, at, driving, hall, level, rules, stage
from tests.support.robots import BY_SPEED


def test_a_sound_robot_violates_nothing_and_drives() -> None:
    outcome = stage(seconds=5.0)
    assert outcome.path > 1.0
    assert outcome.violations == ()


def test_a_base_that_outlives_its_guard_is_seen() -> None:
    outcome = stage(at(2.2, kill("guard"), 1.0), services=broken(base=sabotage.PatientBase), until="ab")
    assert {"a", "b"} <= rules(outcome)


def test_a_command_that_is_too_old_is_seen() -> None:
    patient = broken(base=sabotage.PatientBase, guard=sabotage.PatientGuard)
    outcome = stage(at(2.2, cut("holds"), 1.5), services=patient, until="ab")
    assert {"a", "b"} <= rules(outcome)


def test_a_renewed_tick_is_seen() -> None:
    outcome = stage(at(2.2, unplug("joystick"), 0.9), services=broken(joystick=sabotage.RenewingJoystick), until="b")
    assert "b" in rules(outcome)


def test_an_old_range_is_seen() -> None:
    patient = broken(base=sabotage.PatientBase, guard=sabotage.PatientGuard)
    outcome = stage(at(2.2, unplug("ranger"), 0.6), services=patient, until="b")
    assert "b" in rules(outcome)


def test_motion_under_a_pressed_button_is_seen() -> None:
    pressed = (2.5, 3.5)
    hand = driving((3.3, LEVEL), (4.0, FORWARD))
    outcome = stage(hand=hand, presses=(pressed,), seconds=5.0, services=broken(joystick=sabotage.NumbJoystick))
    assert rules(outcome) == {"c"}
    sound = stage(hand=hand, presses=(pressed,), seconds=5.0)
    assert rules(sound) == set()
    assert sound.counts["the joystick's button is pressed while the robot drives"] == 1
    assert 0.2 < sound.path < outcome.path


def test_a_base_that_arms_by_itself_is_seen() -> None:
    # The hand passes through level in the middle, for far less than 0.2 s.
    fault, hand = at(2.2, reset_board), driving((2.35, LEVEL), (2.45, BACKWARD))
    for reckless in (sabotage.EagerBase, sabotage.HastyBase):
        outcome = stage(fault, hand=hand, seconds=5.0, services=broken(base=reckless), until="c")
        assert "c" in rules(outcome), reckless
    assert rules(stage(fault, hand=hand, seconds=5.0)) == set()


def test_a_command_of_another_than_the_holder_is_seen() -> None:
    fault = at(1.5, typing)
    outcome = stage(fault, hand=level(), seconds=5.0, services=broken(guard=sabotage.OpenGuard), until="c")
    assert "c" in rules(outcome)
    sound = stage(fault, hand=level(), seconds=5.0)
    assert rules(sound) == set()
    assert sound.path == 0.0


def test_motion_under_an_emergency_stop_is_seen() -> None:
    assert "d" in rules(stage(at(2.2, engage), services=broken(base=sabotage.DeafBase), until="d"))


def test_motion_after_the_space_bar_is_seen() -> None:
    fault = at(1.6, typing_a_stop)
    assert "d" in rules(stage(fault, seconds=6.0, services=broken(base=sabotage.DeafBase), until="d"))
    sound = stage(fault, seconds=6.0)
    assert rules(sound) == set()
    assert any(what.startswith("stop: emergency stop by keyboard") for what in sound.counts)


def test_a_latch_that_an_old_reset_clears_is_seen() -> None:
    hand = driving((2.2, LEVEL), (3.6, FORWARD))
    faults = at(2.0, stop, 0.2), at(2.6, engage), at(3.0, replay(EStopReset))
    outcome = stage(*faults, hand=hand, seconds=4.5, services=broken(base=sabotage.ForgivingBase))
    assert "d" in rules(outcome)
    sound = stage(*faults, hand=hand, seconds=4.5)
    assert rules(sound) == set()
    assert sound.path < outcome.path


def test_a_reset_from_before_the_same_engaged_anew_is_seen() -> None:
    faults = at(2.0, engage), at(2.6, engage_anew)
    hand = driving((2.1, LEVEL), (3.3, FORWARD))
    outcome = stage(*faults, hand=hand, seconds=4.3, services=broken(base=sabotage.ForgivingBase))
    assert rules(outcome) == {"d"}
    assert rules(stage(*faults, hand=hand, seconds=4.3)) == set()


def test_a_base_that_forgets_the_stop_at_its_restart_is_seen() -> None:
    hand = driving((2.6, LEVEL), (4.0, FORWARD))
    faults = at(2.0, engage), at(2.5, kill("base"), 0.3)
    outcome = stage(*faults, hand=hand, seconds=5.0, services=broken(base=sabotage.AmnesiacBase))
    assert rules(outcome) == {"d"}
    assert "an emergency stop was lost with its base" not in outcome.counts
    assert rules(stage(*faults, hand=hand, seconds=5.0)) == set()


def test_a_stop_that_was_not_on_disk_when_base_ended_is_lost_with_it() -> None:
    hand = driving((2.6, LEVEL), (4.0, FORWARD))
    faults = at(1.9, hang_disk, 0.5), at(2.0, engage), at(2.2, kill("base"), 0.5)
    outcome = stage(*faults, hand=hand, seconds=5.0)
    assert outcome.counts["an emergency stop was lost with its base"] == 1
    assert rules(outcome) == set()


def test_driving_at_what_has_echoed_is_seen() -> None:
    outcome = stage(seconds=5.5, room=hall(3.8), services=broken(guard=sabotage.BlindGuard))
    assert "e" in rules(outcome)
    assert outcome.contacts == 1
    sound = stage(seconds=5.5, room=hall(3.8))
    assert rules(sound) == set()
    assert sound.contacts == 0


def test_a_fast_touch_of_what_a_sensor_heard_before_it_was_deaf_is_seen() -> None:
    deaf = at(2.5, deafen, 9.0)
    outcome = stage(deaf, seconds=5.5, room=hall(3.8), services=broken(guard=sabotage.BlindGuard))
    assert rules(outcome) == {"h"}
    assert outcome.contacts == 1
    assert rules(stage(deaf, seconds=5.5, room=hall(3.8))) == set()


def test_a_free_way_that_is_refused_is_seen() -> None:
    assert rules(stage(seconds=4.0, services=broken(guard=sabotage.TimidGuard))) == {"f"}


def test_a_way_is_not_free_where_something_may_touch_a_sensor_until_the_robot_has_turned_away() -> None:
    """It was 8 cm before it and went: nothing tells that from what has come so near that no echo is heard."""
    box = at(0.2, touch_sensors, 0.8)
    held = stage(box)
    assert rules(held) == set()
    assert held.path < 0.02
    hand = driving((1.6, LEFT), (3.6, LEVEL), (3.9, FORWARD))
    grudging = stage(box, hand=hand, seconds=6.5, room=hall(2.0), services=broken(guard=sabotage.GrudgingGuard))
    assert rules(grudging) == {"f"}
    sound = stage(box, hand=hand, seconds=6.5, room=hall(2.0))
    assert rules(sound) == set()
    assert sound.path > 0.5


def test_something_thin_ahead_is_no_free_way() -> None:
    room = hall()
    room.add_post("table leg", 2.0, 2.12, 0.03)
    outcome = stage(room=room, seconds=5.0)
    assert rules(outcome) == set()
    assert outcome.path < 0.6


def test_what_an_obstacle_left_behind_is_waited_for_whatever_else_befalls() -> None:
    clearance = ClearanceCheck(world_of(hall(), SETTINGS.robot, SETTINGS.base.drive, SimConfig(), level(), 1), SETTINGS)
    assert clearance.is_calm(0)
    clearance.disturb()
    clearance.disturb()
    clearance.calm(from_us=18_000_000)
    assert not clearance.is_calm(20_000_000)
    clearance.calm(from_us=16_000_000)
    assert not clearance.is_calm(17_999_999)
    assert clearance.is_calm(18_000_000)


def rise_too_fast(counts: Callable[[int], tuple[float, float]]) -> bool:
    """Whether the motors' counts do from 0 ms on, where 100 counts a second are allowed; until then they rest there."""
    judged = Rises(100.0, 100.0)
    found = {}
    for ms in range(-400, 400, 4):
        left, right = counts(max(0, ms))
        found[ms] = judged.judge(left, right, ms * 1000) if left or right else ""
    return any(wrong for ms, wrong in found.items() if ms >= 0)


@pytest.mark.parametrize(("per_second", "is_seen"), [(100, False), (135, False), (140, True)])
@pytest.mark.parametrize(("left", "right"), [(1, 1), (-1, -1), (-1, 1), (1, -1)])
@pytest.mark.parametrize("start", [0, 20])
def test_what_rises_faster_than_its_ramp_is_seen(
    per_second: int, is_seen: bool, left: int, right: int, start: int
) -> None:
    def counts(ms: int) -> tuple[float, float]:
        level = start + per_second * ms / 1000
        return left * level, right * level

    assert rise_too_fast(counts) is is_seen


@pytest.mark.parametrize("reversing", [(46.5, 0.25), (27.0, -14.0)], ids=["is positive", "is negative"])
def test_a_turn_does_not_rise_from_where_a_motor_reverses(reversing: tuple[float, float]) -> None:
    """It is off for a millisecond then: in that step's mean the turn is less than before and after."""

    def counts(ms: int) -> tuple[float, float]:
        if ms < 4:
            return 66.0, 14.0
        return reversing if ms < 8 else (26.5 + ms / 10, -26.5 - ms / 10)

    assert not rise_too_fast(counts)


@pytest.mark.parametrize("dip", [0.0, 20.0, 40.0])
def test_a_leap_back_after_a_frame_of_less_is_seen(dip: float) -> None:
    """One frame lasts 10 ms; it lies at any phase of the steps."""

    def counts(ms: int) -> tuple[float, float]:
        level = dip if 0 < ms <= 12 else 60.0
        return level, level

    assert rise_too_fast(counts)


def test_what_stood_without_power_starts_from_rest() -> None:
    def counts(ms: int) -> tuple[float, float]:
        level = 20.0 if ms == 0 or 20 < ms <= 60 else 0.0
        return level, level

    assert rise_too_fast(counts)


@pytest.mark.parametrize(("second_at", "is_late"), [(0.0, True), (0.3, False)])
def test_of_two_faults_the_later_has_its_own_bound(second_at: float, is_late: bool) -> None:
    body = world_of(hall(), SETTINGS.robot, SETTINGS.base.drive, SimConfig(), level(), 1).body
    stops = Stops(body, lambda _way: True)
    stops.begin(Stop("the network is cut", 0, BEYOND_US, "any", lambda: True))
    stops.begin(Stop("base is unplugged", round(second_at * 1e6), ROBOT_US, "any", lambda: True))
    assert stops.overdue(550_000) == ""
    assert bool(stops.overdue(600_000)) is is_late
    assert stops.overdue(670_000)


@pytest.mark.parametrize(("board", "settles_us"), [("base", 0), ("ardros", 22_000)])
def test_wheels_are_in_their_safe_state_as_soon_as_their_motors_obey(board: BaseBoardName, settles_us: int) -> None:
    drive = msgspec.structs.replace(BY_SPEED, board=board)
    body = WheelsBody(SETTINGS.robot, drive, SimConfig(), hall(), EXACT)
    assert body.settles_us == settles_us, "it is added to each bound"


@pytest.mark.parametrize(
    ("drives", "goes"),
    [
        ((30.0, 30.0), ["any", "travel", "forward"]),
        ((-30.0, -30.0), ["any", "travel", "backward"]),
        ((30.0, -30.0), ["any"]),
    ],
)
def test_a_turn_in_place_is_no_travel(drives: tuple[float, float], goes: list[str]) -> None:
    body = WheelsBody(SETTINGS.robot, BY_SPEED, SimConfig(), hall(), EXACT)
    body.drives, body.plant.speed = drives, sum(drives) * 0.01
    judge = judge_of(body, SETTINGS.robot, SETTINGS.base, 0)
    assert [way for way in get_args(BoundedMotion) if judge.goes(way)] == goes


def test_what_a_slipping_encoder_makes_of_a_turn_in_place_is_no_travel() -> None:
    body = WheelsBody(SETTINGS.robot, BY_SPEED, SimConfig(), hall(), EXACT)
    plant, judge = body.plant, judge_of(body, SETTINGS.robot, SETTINGS.base, 0)
    plant.left.speed, plant.right.speed, body.drives = 0.12, -0.18, (15.0, -23.0)
    plant.speed = -0.03
    assert judge.goes("travel")
    body.slip_encoder(RIGHT, 1.0 / 3.0)
    assert not judge.goes("travel")


def test_a_robot_without_encoders_has_none_cut() -> None:
    run = SimpleNamespace(loop=SimpleNamespace(simulation=SimpleNamespace(world=SimpleNamespace(body=None))))
    assert list(encoder(cast(SimulatedRun, run), Random(1))) == []
