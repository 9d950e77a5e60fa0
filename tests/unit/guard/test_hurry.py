"""What the guard decides at once, and what can wait for its next turn."""

import pytest

from giraff_core.lease import ASK
from tests.unit.guard.rig import FAR, NEAR, OPERATOR, Rig


def driving(linear: float = 0.5, angular: float = 0.0) -> Rig:
    """It has let this pass, with nothing near."""
    rig = Rig()
    rig.look()
    rig.ask(linear, angular)
    assert rig.decide()[0].linear_x == linear
    return rig


@pytest.mark.parametrize("linear", [0.5, 0.2, 0.0], ids=str)
def test_a_word_of_who_drives_cannot_wait(linear: float) -> None:
    rig = driving()
    rig.ask(linear)
    assert rig.hurries


def test_a_fault_of_who_drives_cannot_wait() -> None:
    rig = driving()
    rig.ask(0.0, source="fault", reason="dropped")
    assert rig.hurries


def test_who_is_given_the_lease_need_not_wait_to_hear_of_it(rig: Rig) -> None:
    rig.look()
    rig.ask(0.0, operator="operator-2", counter=ASK, age=0.0)
    assert rig.hurries


def test_what_others_say_can_wait() -> None:
    rig = driving()
    for counter in (ASK, rig.decide()[0].lease_counter):
        rig.ask(0.3, operator="operator-2", name="keyboard", counter=counter)
        assert not rig.hurries


def test_an_old_word_can_wait() -> None:
    rig = driving()
    again = rig.ask(0.4)
    rig.ask(0.0, operator=OPERATOR, seq=again.seq)
    assert not rig.hurries
    rig.ask(0.0, operator=OPERATOR, seq=again.seq - 1)
    assert not rig.hurries


@pytest.mark.parametrize(("linear", "sensor"), [(0.5, "front_left"), (0.5, "front_right"), (-0.5, "rear")])
def test_a_reading_that_stops_what_passes_cannot_wait(linear: float, sensor: str) -> None:
    rig = driving(linear)
    rig.hear(NEAR, sensor, age=0.0)
    assert rig.hurries
    assert rig.decide()[0].linear_x == 0.0


def test_a_reading_that_slows_what_passes_cannot_wait() -> None:
    rig = driving()
    rig.hear(0.4, "front_left", age=0.0)
    assert rig.hurries
    assert 0.0 < rig.decide()[0].linear_x < 0.5


def test_a_sensor_that_fails_on_the_way_cannot_wait() -> None:
    rig = driving()
    rig.hear(sensor="front_left", fault="no echo line", age=0.0)
    assert rig.hurries
    assert rig.decide()[0].linear_x == 0.0


def test_a_reading_that_takes_nothing_away_can_wait() -> None:
    rig = driving()
    rig.hear(FAR, age=0.0)
    assert not rig.hurries
    rig.hear(NEAR, "rear", age=0.0)  # behind
    assert not rig.hurries


def test_a_reading_before_a_robot_that_is_not_asked_to_move_can_wait(rig: Rig) -> None:
    rig.look()
    rig.ask(0.0)
    rig.decide()
    rig.hear(NEAR, age=0.0)
    assert not rig.hurries


def test_a_reading_that_does_not_count_can_wait() -> None:
    rig = driving()
    rig.hear(NEAR, "front_left", ranger="ranger-2", age=0.0)
    assert not rig.hurries
