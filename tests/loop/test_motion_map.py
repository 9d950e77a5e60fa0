"""A go to a point of the map through the whole robot, in simulated time: the motors' record is the judge."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final, NamedTuple

import pytest

from giraff_core.kinematics.pose import Pose
from giraff_schemas.motion import GoTo, MotionGo
from giraff_schemas.topics import POSE
from giraff_sim.hosts.process import Process
from tests.loop.locator import ODOM_IN_MAP, Locator
from tests.loop.motions import Stage, stage
from tests.loop.test_motion_ends import STOPS

AHEAD: Final = Pose(2.0, 0.0, 0.0).placed_in(ODOM_IN_MAP)
"""Of a robot that has not moved yet."""
BEYOND: Final = Pose(4.0, 9.0, 0.0)
"""No place of the plan."""
TOLD: Final = 0.12
"""s until motion hears what localization says of it."""
SILENT: Final = 1.0
"""s after which what it has said counts for nothing."""


class Located(NamedTuple):
    """A robot of which it is known where it is on a map, by whoever says so."""

    stage: Stage
    locator: Locator

    def ask(self, goal: Pose = AHEAD) -> bool:
        """Whether it is accepted."""
        self.stage.ask(MotionGo, steps=(GoTo(x=goal.x, y=goal.y, frame="map"),))
        answer = self.stage.requester.answer
        assert answer is not None
        assert bool(answer.reason) is not answer.accepted
        return answer.accepted


@contextmanager
def located(host: str = "robot") -> Iterator[Located]:
    made: list[Locator] = []

    def make(process: Process) -> Locator:
        made.append(Locator(process))
        return made[-1]

    with stage() as it:
        it.loop.launch("localization", make, it.loop.hosts[host])
        it.run(0.5)
        yield Located(it, made[-1])


def say(it: Located, state: str) -> None:
    it.locator.state = state  # type: ignore[assignment]


def shift(it: Located, odom: Pose) -> None:
    it.locator.odom = odom


def repeat(it: Located) -> None:
    """The same odometry from now on."""
    it.locator.tick = it.locator.newest


def pause(it: Located) -> None:
    it.stage.loop.processes["localization"].paused = True


FAULTS: Final[dict[str, tuple[float, Callable[[Located], object]]]] = {
    "lost": (TOLD, lambda it: say(it, "lost")),
    "ambiguous": (TOLD, lambda it: say(it, "ambiguous")),
    "it turns out to be elsewhere": (TOLD, lambda it: shift(it, ODOM_IN_MAP._replace(x=4.3))),
    "it turns out to look elsewhere": (TOLD, lambda it: shift(it, ODOM_IN_MAP._replace(yaw=1.2))),
    "suspended": (SILENT, pause),
    "it repeats itself": (SILENT + TOLD, repeat),
}
"""s until motion can know of it, and how it comes."""


def test_it_arrives_where_that_is_on_the_map() -> None:
    """A point where nobody can stand is refused before, and turns no wheel."""
    with located("operator") as it:
        asked = it.stage.now
        assert not it.ask(BEYOND)
        it.stage.run(0.5)
        assert it.stage.driven_ms(asked) == 0
        goal = Pose(0.8, 0.0, 0.0).placed_in(ODOM_IN_MAP)
        assert it.ask(goal)
        it.stage.until_ended(15.0)
        assert (it.stage.state.outcome, str(it.stage.state.reason)) == ("arrived", "")
        pose = it.stage.loop.newest[POSE.key]
        assert (pose.x, pose.y) == pytest.approx(goal[:2], abs=0.03)


@pytest.mark.parametrize("fault", FAULTS)
def test_it_stops_when_it_is_not_known_any_more_where_the_robot_is(fault: str) -> None:
    """And it is over: it does not begin anew while that lasts, and nothing moves when that is known again."""
    known, begin = FAULTS[fault]
    with located() as it:
        assert it.ask()
        it.stage.run(0.9)
        assert it.stage.driven_ms(it.stage.now - 0.1) > 90, "it did not move before"
        before = it.stage.now
        begin(it)
        it.stage.run(known + 0.6)
        assert it.stage.last_driven(before) <= known + STOPS
        state = it.stage.state
        assert (state.stage, state.outcome) == ("ended", "lost_localization"), state
        over = it.stage.now
        if not fault.startswith("it turns out"):
            assert not it.ask()
            it.stage.run(0.8)
            assert it.stage.driven_ms(over) == 0
        it.locator.state, it.locator.odom, it.locator.tick = "localized", ODOM_IN_MAP, None
        process = it.stage.loop.processes["localization"]
        process.paused = False
        process.go_on()
        it.stage.run(1.0)
        assert it.stage.driven_ms(over) == 0


def test_what_localization_has_said_moves_nothing_when_it_comes_again() -> None:
    with located() as it:
        it.stage.run(0.3)
        it.stage.loop.kill("localization")
        it.stage.run(1.3)
        asked = it.stage.now
        it.stage.replay(POSE.key)
        it.stage.run(0.1)
        assert not it.ask()
        it.stage.run(1.5)
        assert it.stage.driven_ms(asked) == 0
