"""A command drives only while everything it stands on is fresh, to the nanosecond."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_base.config import BaseConfig
from giraff_schemas.messages import GuardedCommand, RobotTime
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import DriveFrame
from tests.unit.base.rig import CONFIG, EPOCH, STEP_NS, Rig, moving

NS = 1_000_000_000


def driven_by(rig: Rig, **changes: object) -> tuple[tuple[int, int], str]:
    """Levels and reason of the frame at the very moment of a command with these changes."""
    rig.robot_ns += STEP_NS
    rig.say(msgspec.structs.replace(rig.command(), **changes))
    rig.base.on_frames([rig.board.report()], rig.now)
    frame = rig.base.next_frame(rig.now)
    assert isinstance(frame, DriveFrame)
    rig.board.receive(frame)
    return (frame.left_level, frame.right_level), str(rig.base.state().reason)


def aged(rig: Rig, ns: int, epoch: int = EPOCH) -> RobotTime:
    """The moment that is this old at the next frame."""
    return RobotTime(epoch=epoch, robot_ns=rig.robot_ns + STEP_NS - ns)


@pytest.mark.parametrize(
    ("tick", "age_ns", "levels"),
    [
        ("operator_tick", 0, 70),
        ("operator_tick", 200_000_000, 70),
        ("operator_tick", 300_000_000, 35),
        ("operator_tick", 399_999_999, 0),
        ("operator_tick", 400_000_000, 0),
        ("operator_tick", 400_000_001, 0),
        ("guard_tick", 0, 70),
        ("guard_tick", 100_000_000, 70),
        ("guard_tick", 150_000_000, 35),
        ("guard_tick", 199_999_999, 0),
        ("guard_tick", 200_000_000, 0),
        ("range_tick", 0, 70),
        ("range_tick", 399_999_999, 70),
        ("range_tick", 400_000_000, 70),
        ("range_tick", 400_000_001, 0),
        ("range_tick", 999_999_999, 0),
    ],
)
def test_each_tick_counts_to_the_edge_of_its_budget_and_not_beyond(tick: str, age_ns: int, levels: int) -> None:
    rig = Rig()
    rig.drive(0.6)
    driven, reason = driven_by(rig, **{tick: aged(rig, age_ns)})
    assert driven == (levels, levels)
    assert (reason == "") == (levels == 70)
    assert rig.base.state().armed


def test_a_guards_command_beyond_its_edge_is_refused_and_the_one_in_charge_goes_on(driven: Rig) -> None:
    assert driven_by(driven, guard_tick=aged(driven, 200_000_001), linear_x=0.3)[0] == (70, 70)
    assert driven_by(driven, guard_tick=aged(driven, 0), linear_x=0.3)[0] == (35, 35)


@pytest.mark.parametrize("tick", ["operator_tick", "range_tick"])
@pytest.mark.parametrize("moment", ["other epoch", "nobody's epoch", "ahead", "just ahead"])
def test_a_moment_that_proves_nothing_stops_at_once(driven: Rig, tick: str, moment: str) -> None:
    moments = {
        "other epoch": aged(driven, 10, EPOCH + 1),
        "nobody's epoch": aged(driven, 10, 0),
        "ahead": aged(driven, -NS),
        "just ahead": aged(driven, -1),
    }
    levels, reason = driven_by(driven, **{tick: moments[moment]})
    assert levels == (0, 0)
    assert reason


@pytest.mark.parametrize("age_ns", [200_000_001, NS, -1])
def test_when_the_guards_commands_come_too_late_the_last_good_one_runs_out(rig: Rig, age_ns: int) -> None:
    last_good = rig.drive(0.6)[-1].robot_ns - round(rig.guard_age * NS)
    rig.guard_age = age_ns / NS
    sent = rig.run(3.0)
    assert all(each.robot_ns - last_good < 200_000_000 for each in moving(sent))
    assert sent[-1].state.reason


def test_a_command_without_a_guards_or_operators_moment_never_drives() -> None:
    for missing in ("guard_tick", "operator_tick"):
        rig = Rig()
        rig.drive(0.6)
        rig.guard_speaks = False
        for _ in range(100):
            rig.say(msgspec.structs.replace(rig.command(), **{missing: None}))
            rig.run(0.02)
        assert moving(rig.sent[-150:]) == []


def test_nothing_is_asked_of_a_range_that_nothing_relies_on(rig: Rig) -> None:
    rig.drive(0.0, 1.0)
    assert driven_by(rig, range_tick=None) == ((-27, 27), "")


def test_a_rotation_that_the_guard_lets_pass_needs_no_fresh_range_but_a_dead_one_disarms(rig: Rig) -> None:
    rig.drive(0.0, 1.0)
    assert driven_by(rig, range_tick=aged(rig, 900_000_000)) == ((-27, 27), "")
    levels, reason = driven_by(rig, range_tick=aged(rig, 1_100_000_000))
    assert levels == (0, 0)
    assert "stale for too long" in reason


@pytest.mark.parametrize("silent", ["operator", "guard"])
def test_speed_falls_from_half_the_budget_to_zero_at_its_end(silent: str) -> None:
    budget = {"operator": CONFIG.operator_budget, "guard": CONFIG.guard_budget}[silent]
    rig = Rig()
    rig.drive(0.6)
    if silent == "operator":
        last = rig.robot_ns - round(rig.operator_age * NS)
        sent = rig.freeze(0.8)
    else:
        rig.guard_speaks = False
        last = rig.robot_ns - round(rig.guard_age * NS)
        sent = rig.run(0.8)
    for each in sent:
        age = (each.robot_ns - last) / NS
        share = min(1.0, max(0.0, 2.0 - 2.0 * age / budget))
        # The guard's newest command is up to one turn of it old.
        assert abs(each.levels[0] - 70 * share) <= (0.51 if silent == "operator" else 15), (age, each.levels)
        if age >= budget:
            assert not each.moves
        if share < 1.0:
            assert each.state.reason
    assert moving(sent)
    assert sent[-1].state.reason


def test_a_slowed_robot_says_whose_commands_come_late(rig: Rig) -> None:
    rig.operator_age = 0.3
    rig.drive(0.6)
    state = rig.base.state()
    assert 30 <= rig.sent[-1].levels[0] <= 35
    assert "operator" in str(state.reason)
    assert state.round_trip == pytest.approx(0.3, abs=0.02)
    assert state.budget_left == pytest.approx(0.1, abs=0.02)
    rig.operator_age, rig.guard_age = 0.03, 0.15
    rig.run(0.5)
    assert "guard" in str(rig.base.state().reason)


@pytest.mark.parametrize(("linear", "angular"), [(0.6, 0.0), (0.0, 1.5), (0.3, 1.0)])
def test_what_comes_late_drives_and_turns_slower_alike(linear: float, angular: float) -> None:
    levels = []
    for age in (0.03, 0.3):
        rig = Rig()
        rig.arm()
        rig.operator_age = age
        rig.tilt(linear, angular)
        levels.append(rig.run(1.5)[-1].levels)
    for prompt, late in zip(*levels, strict=True):
        assert late == pytest.approx(prompt / 2, abs=3)


def test_each_kind_of_staleness_is_named() -> None:
    reasons = {}
    for tick in ("operator_tick", "range_tick"):
        rig = Rig()
        rig.drive(0.6)
        reasons[tick] = driven_by(rig, **{tick: aged(rig, 500_000_000)})[1]
    assert "operator" in reasons["operator_tick"]
    assert "no fresh command" in reasons["operator_tick"]
    assert "range" in reasons["range_tick"]
    assert "too old" in reasons["range_tick"]


@pytest.mark.parametrize(("linear", "angular"), [(0.3, 0.0), (-0.3, 0.0), (0.3, 0.5), (-0.3, -0.5), (1e-9, 1.0)])
def test_nothing_drives_either_way_on_a_range_that_is_too_old(armed: Rig, linear: float, angular: float) -> None:
    """Though the operator and the guard are fresh."""
    for age, drives in ((0.1, True), (0.5, False)):
        armed.tilt(linear, angular)
        armed.range_age = age
        assert armed.run(1.0)[-1].moves is drives
        armed.tilt(0.0)
        armed.run(0.3)


def test_an_operators_fault_is_named_by_itself_and_by_the_guards_reason_where_there_is_one(driven: Rig) -> None:
    assert driven_by(driven, source="fault") == ((0, 0), "the operator's side reports a fault")
    assert driven_by(driven, source="fault", reason=Trouble("no sensor")) == ((0, 0), "no sensor")


@given(
    operator=st.integers(-NS // 10, 2 * NS),
    guard=st.integers(-NS // 10, NS),
    ranged=st.integers(-NS // 10, 2 * NS),
    epochs=st.tuples(*[st.sampled_from([EPOCH, EPOCH, EPOCH, EPOCH + 1, 0])] * 3),
)
def test_whatever_the_ages_only_fresh_ones_drive(
    operator: int, guard: int, ranged: int, epochs: tuple[int, int, int]
) -> None:
    rig = Rig()
    rig.arm()
    rig.tilt(0.6)
    ages = (operator, guard, ranged)
    budgets = (400_000_000, 200_000_000, 400_000_000)
    ticks = [aged(rig, age, epoch) for age, epoch in zip(ages, epochs, strict=True)]
    levels, reason = driven_by(rig, operator_tick=ticks[0], guard_tick=ticks[1], range_tick=ticks[2])
    good = [0 <= age <= budget and epoch == EPOCH for age, budget, epoch in zip(ages, budgets, epochs, strict=True)]
    if not all(good):
        assert levels == (0, 0)
        # A guard's that is refused leaves the one in charge, which asked for nothing.
        assert reason or not good[1]
    elif operator < 390_000_000 and guard < 195_000_000:
        assert levels != (0, 0)


OFF_AT_ZERO = ("battery_low", "battery_cutoff")


@pytest.mark.parametrize("field", [name for name in BaseConfig.__struct_fields__ if name not in ("port", "drive")])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_a_budget_that_is_none_is_refused_by_name(field: str, value: float) -> None:
    if value == 0.0 and field in OFF_AT_ZERO:
        assert msgspec.structs.replace(CONFIG, **dict.fromkeys(OFF_AT_ZERO, 0.0)).battery_low == 0.0
        return
    with pytest.raises(ValueError, match=field):
        msgspec.structs.replace(CONFIG, **{field: value})


def test_commands_are_compared_with_the_moment_they_are_used_and_not_with_their_arrival(driven: Rig) -> None:
    driven.guard_speaks = False
    fresh: GuardedCommand = driven.command()
    driven.say(fresh)
    driven.robot_ns += 500_000_000
    assert not driven.run(0.01)[-1].moves
