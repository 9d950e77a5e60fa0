"""What ends a motion, whom it gives way to, and that nothing said of it once moves the robot again: in simulated time.

The motors' record is the judge.
"""

from typing import Any, Final

import pytest

from giraff_schemas.motion import GoTo, MotionArc, MotionGo, MotionMove, MotionRequest, MotionTurn, Move, Turn
from giraff_schemas.topics import LEASE, MOTION_HOLD, MOTION_MOVE
from tests.loop.motions import AHEAD, Stage, stage
from tests.sim.robots import proving_room

PRIMITIVES: Final[dict[str, tuple[type[MotionRequest], dict[str, Any]]]] = {
    "ahead": (MotionMove, AHEAD),
    "back": (MotionMove, {"distance": -2.0}),
    "turn": (MotionTurn, {"angle": 6.0}),
    "arc": (MotionArc, {"radius": 0.6, "angle": -6.0}),
    "go": (MotionGo, {"steps": (GoTo(x=2.0, y=0.0), Turn(angle=1.0), Move(distance=0.5))}),
}
STOPS: Final = 0.1
"""s from a cancel to PWM 0."""
RESTS: Final = 0.45
"""s from there to rest."""


def speed(it: Stage) -> float:
    """m/s or rad/s, in truth."""
    plant = it.loop.simulation.world.plant
    return max(abs(plant.speed), abs(plant.turn))


@pytest.mark.parametrize("name", PRIMITIVES)
def test_each_of_them_is_cancelled_at_once(name: str) -> None:
    kind, fields = PRIMITIVES[name]
    with stage() as it:
        it.begin(kind, **fields)
        it.run(0.4)
        assert it.driven_ms(it.now - 0.1) > 90
        cancelled = it.now
        it.cancel()
        it.run(RESTS)
        assert speed(it) < 0.01
        it.run(0.5)
        assert it.last_driven(cancelled) <= STOPS
        assert (it.state.stage, it.state.outcome, str(it.state.reason)) == (
            "ended",
            "cancelled",
            "cancelled by a script",
        )


@pytest.mark.parametrize(("beside", "sensor"), [(0.15, "front_left"), (-0.15, "front_right")])
def test_it_stops_before_an_obstacle_and_says_which_sensor_sees_it(beside: float, sensor: str) -> None:
    room = proving_room()
    room.add_wall("box", [(1.4, beside - 0.12), (1.4, beside + 0.12)])
    with stage(room) as it:
        began = it.now
        it.begin(MotionMove, **AHEAD)
        it.until_ended(5.0)
        it.run(1.1)
        assert (it.state.stage, it.state.outcome, it.state.sensor) == ("ended", "blocked", sensor), it.state
        assert sensor in str(it.state.reason)
        assert it.driven_ms(it.now - 1.0) == 0
        assert it.loop.simulation.world.plant.contacts == 0
        assert 0.2 < it.state.achieved.path < 0.9
        assert it.driven_ms(began) > 500


def test_a_persons_key_takes_the_robot_and_the_motion_asks_no_more() -> None:
    with stage() as it:
        it.start_keyboard()
        it.run(0.2)
        it.begin(MotionMove, **AHEAD)
        it.run(0.4)
        assert it.loop.newest[LEASE.key].operator == "motion"
        taken = it.now
        it.type(b"w", 0.2)
        it.run(1.0)
        assert it.loop.newest[LEASE.key].operator == "keyboard"
        assert it.last_driven(taken) <= STOPS
        assert (it.state.stage, it.state.outcome) == ("ended", "lost_lease")
        it.loop.terminate("keyboard")
        it.run(2.5)
        assert it.loop.newest[LEASE.key].operator == ""
        assert it.driven_ms(taken + STOPS) == 0


def test_while_somebody_else_drives_it_is_refused_with_who_that_is() -> None:
    with stage() as it:
        it.start_keyboard()
        it.run(0.2)
        it.type(b"c", 0.2)
        it.run(0.5)
        counter = it.loop.newest[LEASE.key].counter
        it.ask(MotionMove, **AHEAD)
        answer = it.requester.answer
        assert answer is not None
        assert not answer.accepted
        assert "keyboard" in str(answer.reason)
        asked = it.now
        it.run(2.0)
        assert (it.loop.newest[LEASE.key].operator, it.loop.newest[LEASE.key].counter) == ("keyboard", counter)
        assert it.driven_ms(asked) == 0


def test_an_emergency_stop_ends_it_and_a_reset_moves_nothing() -> None:
    with stage() as it:
        it.start_stopper()
        it.begin(MotionMove, **AHEAD)
        it.run(0.4)
        stopped = it.now
        it.engage()
        it.run(1.5)
        assert it.last_driven(stopped) <= STOPS
        assert (it.state.stage, it.state.outcome) == ("ended", "disarmed")
        it.reset()
        it.run(2.0)
        assert not it.loop.newest["estop"].engaged
        assert it.driven_ms(stopped + STOPS) == 0
        it.begin(MotionMove, **AHEAD)


@pytest.mark.parametrize("anew", [False, True], ids=["it runs on", "it was started anew"])
def test_what_was_asked_once_moves_nothing_when_it_comes_again(anew: bool) -> None:
    """Word for word, with all that the requester has said: after its end, and to another process."""
    with stage() as it:
        it.begin(MotionMove, distance=0.15)
        it.until_ended(3.0)
        it.run(0.5)
        assert it.state.outcome == "arrived"
        it.loop.kill("requester")
        if anew:
            it.loop.kill("motion")
            it.loop.start("motion")
            it.run(1.0)
        over = it.now
        it.replay(MOTION_MOVE.key, MOTION_HOLD.key)
        it.run(2.5)
        assert it.driven_ms(over) == 0
        assert it.loop.newest[LEASE.key].operator == ""


def test_a_script_that_only_asks_moves_nothing() -> None:
    with stage() as it:
        it.ask(MotionMove, **AHEAD)
        it.loop.kill("requester")
        asked = it.now
        it.run(2.0)
        assert it.driven_ms(asked) == 0
        assert it.state.outcome in ("lost_requester", "disarmed")
