"""Who asks for a motion: what is said meanwhile, and what is concluded of what is heard, and of what is not."""

import math
from collections.abc import Callable
from itertools import pairwise

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.motion.requester import ANSWERS_WITHIN, ENDS_WITHIN, MotionRequester
from giraff_core.motion.result import MotionResult, way_of
from giraff_core.motion.wish import Wish
from giraff_core.operator import LINK_SILENCE
from giraff_schemas.codec import stamped
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.motion import NOWHERE, MotionAnswer, MotionGo, MotionHold, MotionState, Move
from giraff_schemas.trouble import Trouble
from tests.support.motion_double import BLOCKED, motion_state

WISH = 5
AHEAD = Wish([Move(distance=1.0)], 0.3, None, 20.0)
YES = MotionAnswer(accepted=True)
STEP = 0.01


def tick(at: float, epoch: int = 1) -> Tick:
    return Tick(epoch=epoch, robot_ns=round(at * 1e9))


def said(state: MotionState, seq: int, instance: str = "one") -> MotionState:
    return stamped(state, seq, 0, instance)


class Line:
    """A requester, a robot that ticks fifty times a second, and a motion that speaks ten times, until told not to."""

    def __init__(self) -> None:
        self.it = MotionRequester(WISH, AHEAD, "ann@desk", "asker")
        self.turns = 0
        self.ticks = self.speaks = True
        self.holds: list[tuple[float, MotionHold]] = []
        self.result: MotionResult | None = None

    @property
    def now(self) -> float:
        return self.turns * STEP

    def run(self, seconds: float) -> MotionResult | None:
        """So long, or until it concludes."""
        for _ in range(round(seconds / STEP)):
            self.turns += 1
            if self.ticks and self.turns % 2 == 0:
                self.it.on_tick(tick(self.now), self.now)
            if self.speaks and self.turns % 10 == 0:
                self.it.on_state(said(motion_state(WISH), self.turns), self.now)
            if (hold := self.it.hold(self.now)) is not None:
                self.holds.append((self.now, hold))
            self.result = self.it.result(self.now)
            if self.result is not None:
                break
        return self.result

    @property
    def end(self) -> MotionResult:
        assert self.result is not None
        return self.result

    def ask(self) -> None:
        """Ask once the robot is heard, and hear no answer."""
        self.speaks = False
        self.run(0.1)
        assert self.it.ask(self.now) is not None

    def begin(self) -> None:
        """Ask, and be told yes."""
        self.ask()
        self.it.on_answer(YES, self.now)
        self.speaks = True


@pytest.fixture
def line() -> Line:
    return Line()


@pytest.fixture
def begun(line: Line) -> Line:
    line.begin()
    return line


def test_it_asks_once_the_robot_is_heard_and_with_its_newest_tick(line: Line) -> None:
    assert line.it.ask(0.0) is None
    line.it.on_tick(tick(3.0), 0.1)
    line.it.on_tick(tick(3.02), 0.12)
    line.it.on_tick(tick(3.01), 0.13)
    request = line.it.ask(0.2)
    assert isinstance(request, MotionGo)
    assert (request.id, request.by, request.tick) == (WISH, "ann@desk", RobotTime(epoch=1, robot_ns=3_020_000_000))
    assert (request.steps, request.speed, request.time_limit) == ((Move(distance=1.0),), 0.3, 20.0)


def test_it_asks_nothing_of_a_robot_that_is_not_heard_any_more(line: Line) -> None:
    line.it.on_tick(tick(3.0), 0.1)
    assert line.it.ask(0.1 + LINK_SILENCE + 0.01) is None


def test_it_holds_on_25_times_a_second_once_it_is_accepted(line: Line) -> None:
    line.speaks = False
    line.run(0.5)
    assert line.holds == []
    line.it.ask(line.now)
    line.it.on_answer(YES, line.now)
    line.speaks = True
    assert line.run(4.0) is None
    assert len(line.holds) == pytest.approx(100, abs=1)
    assert {hold.id for _, hold in line.holds} == {WISH}
    assert all(at - hold.tick.robot_ns * 1e-9 < 0.025 for at, hold in line.holds), "the newest that was heard"


def test_nothing_is_held_before_it_is_accepted(line: Line) -> None:
    """So that nothing has moved where nobody is heard to have accepted it."""
    line.ask()
    line.it.on_fault("motion/go: not a MotionGo")
    result = line.run(ANSWERS_WITHIN + 0.1)
    assert line.holds == []
    assert result is not None
    assert (result.outcome, result.begun) == ("unanswered", False)
    assert result.reason.startswith("motion/go: not a MotionGo; check that")


def test_one_that_stood_still_hears_first_how_it_ended_meanwhile(begun: Line) -> None:
    begun.run(0.2)
    begun.turns += 200
    begun.speaks = False
    assert begun.run(0.05) is None
    ended = msgspec.structs.replace(motion_state(WISH), stage="ended", outcome="lost_requester")
    begun.it.on_state(said(ended, begun.turns), begun.now)
    result = begun.run(0.05)
    assert result is not None
    assert result.outcome == "lost_requester"


def test_a_tick_that_was_said_is_not_said_again(begun: Line) -> None:
    begun.run(0.2)
    begun.ticks = False
    begun.holds.clear()
    begun.run(LINK_SILENCE + 0.1)
    assert len(begun.holds) <= 1
    assert begun.end.outcome == "lost_robot"


@given(
    st.lists(
        st.tuples(st.integers(1, 3), st.integers(0, 400), st.integers(0, 60)),
        max_size=60,
    )
)
def test_no_hold_has_a_tick_that_was_not_heard_and_none_has_one_twice_in_a_row(
    heard: list[tuple[int, int, int]],
) -> None:
    """Whatever comes, in which order, and however late: ticks of several epochs at their own times."""
    it, now = MotionRequester(WISH, AHEAD, "ann", "asker"), 0.0
    it.on_tick(tick(0.001, 9), now)
    assert it.ask(now) is not None
    it.on_answer(YES, now)
    ticks, holds = {RobotTime(epoch=9, robot_ns=1_000_000)}, list[MotionHold]()
    for epoch, robot_cs, wait in heard:
        now += wait * 0.01
        its = tick(robot_cs * 0.01, epoch)
        it.on_tick(its, now)
        ticks.add(its.time)
        it.on_state(said(motion_state(WISH), len(ticks)), now)
        hold = it.hold(now)
        holds += [hold] if hold is not None else []
    assert {hold.tick for hold in holds} <= ticks
    assert all(one.tick != other.tick for one, other in pairwise(holds))


def test_it_ends_as_motion_says(begun: Line) -> None:
    begun.run(0.5)
    blocked = motion_state(WISH, "ended", "blocked", sensor="front_left", reason=BLOCKED)
    begun.it.on_state(said(blocked, begun.turns + 1), begun.now)
    result = begun.it.result(begun.now)
    assert result is not None
    assert (result.outcome, result.begun, result.arrived) == ("blocked", True, False)
    assert (result.sensor, result.reason) == ("front_left", BLOCKED)
    assert (result.asked.path, result.achieved.path) == (1.0, 0.5)
    assert result.standard_deviations == pytest.approx((0.01, 0.02, 0.03))
    assert result.way == "0.500 of 1.000 m; ± 0.010 m ahead, 0.020 m aside, 1.7° (1 sigma)"
    begun.it.on_state(said(motion_state(WISH), begun.turns + 2), begun.now)
    begun.it.on_tick(tick(begun.now + 0.1), begun.now + 0.1)
    assert begun.it.hold(begun.now + 0.1) is None, "what has ended is not held"


def test_a_state_that_comes_late_takes_nothing_back(begun: Line) -> None:
    begun.it.on_state(said(motion_state(WISH, "ended", "arrived"), 9_000), begun.now)
    begun.it.on_state(said(motion_state(WISH), 8_999), begun.now)
    assert begun.run(0.1) is not None
    assert begun.end.arrived


def test_a_refusal_is_its_end_and_nothing_has_moved(line: Line) -> None:
    line.ask()
    line.it.on_answer(MotionAnswer(accepted=False, reason=Trouble("held by joystick")), line.now)
    line.it.on_answer(YES, line.now)
    assert line.run(1.0) == MotionResult(outcome="refused", begun=False, reason="held by joystick")


def test_where_nobody_answers_it_says_where_to_look(line: Line) -> None:
    line.ask()
    asked = line.now
    line.it.on_state(said(motion_state(4, "ended", "arrived"), 1), line.now)
    line.run(10.0)
    assert line.now - asked == pytest.approx(ANSWERS_WITHIN, abs=0.03)
    assert (line.end.outcome, line.end.begun) == ("unanswered", False)
    assert "check that giraff_motion runs; on a secured network [network.access] says who may ask" in line.end.reason


def test_an_answer_that_is_lost_is_no_matter_where_the_motion_is_heard(line: Line) -> None:
    line.ask()
    line.speaks = True
    assert line.run(2.0 * ANSWERS_WITHIN) is None
    line.it.on_answer(MotionAnswer(accepted=False, reason=Trouble("it is too old")), line.now)
    assert line.run(1.0) is None


@pytest.mark.parametrize("heard", [True, False])
def test_a_motion_of_which_nothing_is_heard_for_a_second_is_given_up(begun: Line, heard: bool) -> None:
    begun.speaks = heard
    begun.run(0.4)
    begun.speaks, since = False, begun.now
    begun.run(5.0)
    assert begun.now - since == pytest.approx(AHEAD.asked.silence - (0.0 if heard else 0.4), abs=0.12)
    assert (begun.end.outcome, begun.end.begun) == ("unheard", True)
    assert begun.end.achieved.path == (0.5 if heard else 0.0)
    assert "giraff_motion is silent for 1 s" in begun.end.reason


def test_a_robot_that_is_lost_is_its_end(begun: Line) -> None:
    begun.run(0.4)
    begun.ticks, since = False, begun.now
    begun.run(5.0)
    assert begun.now - since == pytest.approx(LINK_SILENCE, abs=0.04)
    assert (begun.end.outcome, begun.end.begun) == ("lost_robot", True)
    assert "no tick of the robot for 0.5 s" in begun.end.reason


def another_request(turn: int) -> MotionState:
    return said(msgspec.structs.replace(motion_state(6), by="bob"), turn)


def another_process(turn: int) -> MotionState:
    return said(motion_state(0, "idle"), turn, "two")


def the_same_of_another(turn: int) -> MotionState:
    return said(motion_state(WISH), turn, "two")


@pytest.mark.parametrize(
    ("other", "why"),
    [
        (another_request, "the motion of bob has come after it"),
        (another_process, "another giraff_motion speaks: it was started anew, or there are two"),
        (the_same_of_another, "another giraff_motion speaks"),
    ],
)
def test_another_in_its_place_is_its_end(begun: Line, other: Callable[[int], MotionState], why: str) -> None:
    begun.run(0.3)
    begun.it.on_state(other(begun.turns + 1), begun.now)
    result = begun.it.result(begun.now)
    assert result is not None
    assert (result.outcome, result.begun) == ("unheard", True)
    assert why in result.reason
    begun.it.on_tick(tick(begun.now + 0.1), begun.now + 0.1)
    assert begun.it.hold(begun.now + 0.1) is None


def test_what_is_said_of_others_before_it_is_no_matter(begun: Line) -> None:
    begun.it.on_state(said(motion_state(4), 1), begun.now)
    begun.run(0.3)
    begun.it.on_state(said(motion_state(4), 2), begun.now)
    assert begun.run(0.3) is None


def test_a_cancel_lets_go_at_once_and_waits_for_the_end(begun: Line) -> None:
    begun.run(0.5)
    assert begun.it.cancel(begun.now).id == WISH
    begun.holds.clear()
    assert begun.run(0.5) is None
    assert begun.holds == []
    begun.it.on_state(
        said(motion_state(WISH, "ended", "cancelled", reason=Trouble("cancelled by ann")), 9_000), begun.now
    )
    assert begun.run(0.1) is not None
    assert (begun.end.outcome, begun.end.reason) == ("cancelled", "cancelled by ann")


@pytest.mark.parametrize("ticks", [True, False])
def test_a_cancel_of_which_nothing_is_heard_is_given_up(begun: Line, ticks: bool) -> None:
    begun.run(0.5)
    begun.ticks = ticks
    begun.it.cancel(begun.now)
    since = begun.now
    begun.run(0.1)
    begun.it.cancel(begun.now)
    begun.run(10.0)
    assert begun.now - since == pytest.approx(ENDS_WITHIN, abs=0.03)
    assert (begun.end.outcome, begun.end.begun) == ("unheard", True)
    assert ("its end was not heard" if ticks else "no tick of the robot") in begun.end.reason


def test_what_is_cancelled_before_it_has_begun_has_not_moved(line: Line) -> None:
    line.speaks = False
    line.it.cancel(line.now)
    result = line.it.result(line.now)
    assert result is not None
    assert (result.outcome, result.begun) == ("cancelled", False)


def test_a_way_is_told_in_what_was_asked_for() -> None:
    turned = msgspec.structs.replace(NOWHERE, yaw=math.pi)
    both = msgspec.structs.replace(turned, path=1.0)
    state = motion_state(WISH)
    assert way_of(msgspec.structs.replace(state, asked=turned)) == "1.1 of 180.0°"
    assert way_of(msgspec.structs.replace(state, asked=both)) == "0.500 of 1.000 m, 1.1 of 180.0°"
    assert way_of(msgspec.structs.replace(state, asked=NOWHERE)) == "0.500 of 0.000 m"
