"""The demonstration of `giraff run` and who else drives, with the services themselves, in simulated time."""

import msgspec
import pytest

from giraff_cli.run import demonstration
from giraff_cli.run.demonstration import ASKS, DRIVES, FLAT, QUIET, WARNING
from giraff_core.lease import unranked_notice
from giraff_joystick.config import JoystickConfig
from giraff_schemas.services import DEMONSTRATION
from tests.loop.loops import closed_loop
from tests.loop.operators import LOOK, SETTINGS, scene
from tests.sim.robots import proving_room

STOPS = 0.12
"""s from a word of the guard to PWM zero."""
SOON = 6.0
"""s of quiet, and of rest until the guard ends a lease. The defaults are 30 s each, which unit tests show."""


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    assert SETTINGS.guard.idle_release <= QUIET
    monkeypatch.setattr(demonstration, "QUIET", SOON)


@pytest.mark.usefixtures("soon")
def test_a_key_takes_the_robot_and_the_demonstration_drives_on_some_time_after_the_last() -> None:
    with scene(idle_release=SOON) as it:
        it.hold(b"w", 0.5)
        taken = it.now - 0.5 + STOPS
        assert (it.driver, it.armed, it.grip) == ("keyboard", False, FLAT)
        it.hold(b"w", 1.0)
        it.run(0.2)
        assert it.driven_ms(taken) == 0, "a key that is held since the takeover must not drive"
        it.run(1.0)
        assert it.armed, "no key is pressed"
        assert it.driven_ms(taken) == 0, "a robot that arms must not move"
        it.hold(b"w", 1.0)
        assert it.driven_ms(taken) > 300
        last = it.now
        it.run(0.6)
        rested = it.now
        it.run(SOON - WARNING - 1.0)
        assert it.run_in_part.demonstration.note.startswith("keyboard drives")
        it.run(1.5)
        assert "drives on in 3 s" in it.run_in_part.demonstration.note
        drives = it.until_it_drives(8.0)
        assert it.driver == DEMONSTRATION
        assert it.driven_ms(rested, last + SOON) == 0
        assert drives - last < SOON + 4.0
        assert [grip for _, grip in it.run_in_part.grips] == [DRIVES, FLAT, ASKS, FLAT, DRIVES]


def test_a_keyboard_that_ends_at_once_does_not_give_the_robot_back() -> None:
    """Its lease ends after a second of silence: the hand is flat by then, whenever the run looks."""
    with scene() as it:
        it.hold(b"w", 0.1)
        assert it.driver == "keyboard"
        taken = it.now
        it.loop.kill("keyboard")
        it.run(3.0)
        assert it.driver == ""
        assert it.driven_ms(taken + STOPS) == 0


def test_a_run_that_looked_too_seldom_would_ask_again() -> None:
    with scene(every=3.0) as it:
        looks = it.run_in_part.looks
        while it.run_in_part.looks == looks:
            it.run(0.1)
        it.hold(b"w", 0.1)
        assert it.driver == "keyboard"
        it.loop.kill("keyboard")
        it.run(1.5)
        assert it.driver == DEMONSTRATION


def test_asking_without_driving_stops_the_demonstration_too() -> None:
    with scene() as it:
        it.hold(b"c", 0.04)
        it.run(LOOK)
        assert it.grip == FLAT
        it.run(0.3)
        assert it.driven_ms(it.now - 0.1) == 0


@pytest.mark.usefixtures("soon")
def test_an_emergency_stop_and_its_reset_move_nothing_for_some_time() -> None:
    with scene(idle_release=SOON) as it:
        it.engage()
        it.run(0.5)
        stopped = it.now
        assert it.grip == FLAT
        it.run(SOON)
        it.reset()
        reset = it.now
        it.run(SOON)
        assert not it.loop.newest["estop"].engaged
        assert it.driven_ms(stopped) == 0
        drives = it.until_it_drives(8.0)
        assert drives - reset < SOON + 4.0
        assert it.driver == DEMONSTRATION


@pytest.mark.parametrize("operator", ["gamepad", "joystick"])
def test_a_hand_with_a_name_that_no_table_ranks_is_told_so_by_the_guard(operator: str) -> None:
    named = msgspec.structs.replace(SETTINGS, joystick=JoystickConfig(port="joystick", operator=operator))
    with closed_loop(proving_room(), named) as loop:
        loop.run(0.5)
        told = {str(unranked_notice("gamepad"))} if operator == "gamepad" else set()
        for process in ("guard", "joystick"):
            assert {text for text in loop.processes[process].told.values() if "no priority" in text} == told
