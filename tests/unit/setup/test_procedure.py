"""A person is led through the runs: what goes wrong is named, the run is done again, and no other one is lost."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from giraff_setup.wheels.odometry.plan import PLAN
from giraff_setup.wheels.odometry.procedure import Measured, Procedure
from giraff_tools.terminal.human import NobodyError
from tests.unit.setup.person import GEOMETRY, Act, FiledRobot, Person


def guided(
    instead: Mapping[tuple[str, int], Act | str] | None = None, robot: FiledRobot | None = None
) -> tuple[Person, Measured]:
    """Return who was led, and what was measured; `instead`: what that person does otherwise."""
    robot = robot or FiledRobot()
    person = Person(robot, instead)
    return person, Procedure(person, robot, GEOMETRY).measure()


def test_each_run_of_the_plan_is_marked_driven_and_measured_and_what_is_driven_is_shown() -> None:
    person, measured = guided()
    assert [run.name for run in (*measured.fitted, *measured.checks)] == [leg.name for leg in PLAN]
    assert [run.name for run in measured.checks] == [leg.name for leg in PLAN if leg.is_check]
    line, turns = measured.fitted[0], measured.fitted[4]
    assert (np.sum(line.left), np.sum(line.right)) == pytest.approx((10_000, 10_000), abs=1)
    assert line.measured[-1].row == line.left.size
    assert line.measured[-1][1:] == pytest.approx((5.0, 0.0, 0.0), abs=1e-9)
    assert turns.measured[-1].yaw == pytest.approx(3 * 2 * np.pi, abs=0.01)
    assert "5.0 m, turned 0 degrees" in person.shown
    assert "0.0 m, turned -1080 degrees" in person.shown
    assert "8.0 m, turned 360 degrees" in person.shown


def spoiled(spoil: Callable[[FiledRobot], None]) -> Callable[[FiledRobot, Person], str]:
    """The robot drives what it is asked to, and in the middle of it something happens."""

    def act(robot: FiledRobot, person: Person) -> str:
        robot.roll(1.0, 1.0)
        spoil(robot)
        return person.drive()

    return act


def driving(leg: str, says: str = "") -> Callable[[FiledRobot, Person], str]:
    """The robot is driven otherwise than it is asked to."""

    def act(robot: FiledRobot, person: Person) -> str:
        del person
        if leg:
            robot.drive(leg)
        return says

    return act


def restart_board(robot: FiledRobot) -> None:
    robot.boot_id = 2


def restart_base(robot: FiledRobot) -> None:
    robot.instance = "base-2"


def lose_half_an_hour(robot: FiledRobot) -> None:
    """So long that the board's time says nothing any more."""
    robot.robot_ns += (1 << 31) * 1000


def lose_network(robot: FiledRobot) -> None:
    robot.is_heard = False
    robot.roll(1.0, 1.0)
    robot.is_heard = True


@pytest.mark.parametrize(
    ("act", "cause"),
    [
        (spoiled(restart_board), "board has started again"),
        (spoiled(restart_base), "another base process"),
        (spoiled(lose_half_an_hour), "board's time may have wrapped"),
        (spoiled(FiledRobot.leap), "a counter leapt"),
        (spoiled(lose_network), "silent while it moved"),
        (driving(""), "have not turned"),
        (driving("turns left"), "it went 0.00 m"),
        (driving("square left"), "it turned 360"),
        (driving("", says="again"), "Once more"),
    ],
)
def test_a_run_that_went_wrong_is_done_again(act: Callable[[FiledRobot, Person], str], cause: str) -> None:
    robot = FiledRobot()
    person = Person(robot, {("Drive", 1): lambda: act(robot, person)})
    measured = Procedure(person, robot, GEOMETRY).measure()
    assert any(cause in text for text in person.told), person.told
    assert len(measured.fitted) + len(measured.checks) == len(PLAN)
    assert person.count("Drive") == len(PLAN) + 1
    assert np.sum(measured.fitted[0].left) == pytest.approx(10_000, abs=1)


@pytest.mark.parametrize("question", ["Mark", "Drive"])
def test_a_robot_that_moves_has_not_begun_or_ended(question: str) -> None:
    robot = FiledRobot()

    def roll() -> str:
        robot.roll(0.1, 0.1)
        return ""

    def wait() -> str:
        robot.stand()
        return "" if question == "Mark" else person.drive()

    person = Person(robot, {(question, 1): roll, (question, 2): wait})
    measured = Procedure(person, robot, GEOMETRY).measure()
    assert any("wheels still turn" in text for text in person.told)
    rolled = 200 if question == "Drive" else 0
    assert np.sum(measured.fitted[0].left) == pytest.approx(10_000 + rolled, abs=1)


def test_wheels_that_are_not_heard_are_named_and_waited_for() -> None:
    robot = FiledRobot()

    def fall_silent() -> str:
        robot.silence = 5.0
        return ""

    def speak() -> str:
        robot.silence = 0.0
        return ""

    person, measured = guided({("Mark", 1): fall_silent, ("Mark", 2): speak}, robot)
    assert len(measured.fitted) == 6
    assert any("no wheels are heard" in text for text in person.told)
    assert "no wheels are heard" in person.shown[0]


@pytest.mark.parametrize("question", ["Mark", "Drive"])
@pytest.mark.parametrize("typed", ["help", "agian", "5.0"])
def test_only_enter_is_enter(question: str, typed: str) -> None:
    person, measured = guided({(question, 1): typed})
    assert len(measured.fitted) == 6
    assert person.count(question) == len(PLAN) + 1
    assert person.told.count("Press ENTER, or type again or skip.") == 1


@pytest.mark.parametrize(
    "typed",
    [
        *("", "five", "nan", "inf", "1,234.5", "5 feet", "--5"),
        *("5_0", "\u0665", "\uff15", "5e0", "5 . 0", ".", "5.0.", "9" * 400),
    ],
)
def test_what_is_no_number_is_asked_again(typed: str) -> None:
    person, measured = guided({("ahead", 2): typed})
    assert measured.fitted[1].measured[-1].x == pytest.approx(5.0)
    assert person.count("ahead") == len(PLAN) + 1
    assert any("no number" in text for text in person.told)


@pytest.mark.parametrize(
    ("typed", "metres"), [("5,012", 5.012), ("5012 mm", 5.012), ("501.2cm", 5.012), ("+5.012 m", 5.012), ("5.", 5.0)]
)
def test_a_number_may_have_a_comma_and_a_unit(typed: str, metres: float) -> None:
    _, measured = guided({("ahead", 1): typed})
    assert measured.fitted[0].measured[-1].x == pytest.approx(metres)


@pytest.mark.parametrize(
    ("what", "typed", "cause"),
    [
        ("ahead", "5012", "type 5012 mm"),
        ("ahead", "-5.012", "is its sign right"),
        ("ahead", "0.1", "these marks those of this run"),
        ("aside", "4", "aside is 4 m"),
        ("heading", "1,5", "1.5 has no unit: 1.5deg, or 1.5rad"),
        ("heading", "90deg", "heading is 90 degrees"),
    ],
)
def test_a_measure_that_no_wheels_explain_is_asked_again(what: str, typed: str, cause: str) -> None:
    person, measured = guided({(what, 1): typed})
    assert measured.fitted[0].measured[-1][1:] == pytest.approx((5.0, 0.0, 0.0), abs=1e-9)
    assert any(cause in text for text in person.told), person.told
    assert person.count("Drive") == len(PLAN), "it is measured again, not driven again"


def test_a_run_is_left_out_or_done_again_by_a_word() -> None:
    person, measured = guided({("Mark", 2): "skip", ("aside", 2): "again", ("ENTER", 1): "17"})
    assert [run.name for run in measured.fitted][:3] == ["line 1", "line 3", "line 4"]
    assert person.count("Drive") == len(PLAN)  # one less, one more
    assert any("17: no number of a run" in text for text in person.told)


def test_at_the_end_one_may_be_done_again_after_all() -> None:
    _, measured = guided({("ENTER", 1): "3", ("ahead", 9): "5.02"})
    assert [run.measured[-1].x for run in measured.fitted[:4]] == pytest.approx([5.0, 5.0, 5.02, 5.0])


@pytest.mark.parametrize(("what", "typed"), [("aside", "0.3"), ("ahead", "5.1"), ("heading", "8deg")])
def test_a_run_that_does_not_agree_with_the_others_is_named(what: str, typed: str) -> None:
    person, measured = guided({(what, 3): typed, ("ENTER", 1): "3"})
    named = [text for text in person.told if "does not agree" in text]
    assert len(named) == 1
    assert named[0].startswith("line 3"), named
    assert measured.fitted[2].measured[-1][1:] == pytest.approx((5.0, 0.0, 0.0), abs=1e-9)


def test_runs_that_tell_too_little_are_named() -> None:
    person, _ = guided({("Mark", 5): "skip", ("Mark", 6): "skip"})
    assert any("not determined" in text for text in person.told)


def test_nobody_who_answers_ends_it() -> None:
    def leave() -> str:
        raise NobodyError

    with pytest.raises(NobodyError):
        guided({("Drive", 3): leave})
