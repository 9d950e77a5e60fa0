"""Whose flood of commands it is, and that a busy hand is none."""

import pytest

from giraff_core.lease import ASK
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.guard.rig import Rig


def ask(rig: Rig, seconds: float, rates: dict[str, float]) -> set[str]:
    """Commands of operators by name, each so many a second; what the guard tells, deciding fifty times a second."""
    told = set()
    for step in range(round(seconds * 1000)):
        rig.robot_ns += 1_000_000
        if step % 20 == 0:
            rig.tick()
            rig.decide()
            told.add(str(rig.guard.flood))
        for name, rate in rates.items():
            for _ in range(int((step + 1) * rate / 1000) - int(step * rate / 1000)):
                rig.ask(0.1, operator=f"{name}-instance", name=name, age=0.0)
    return told


@pytest.mark.parametrize("flooder", ["joystick", "stranger"])
def test_a_flood_is_told_by_who_makes_it(rig: Rig, flooder: str) -> None:
    ask(rig, 3.5, {"joystick": 50, flooder: 2000})
    assert f"most of them from {flooder};" in str(rig.guard.flood)


def test_a_flooder_of_many_instances_or_names_is_not_taken_for_the_hand() -> None:
    for many_names in (False, True):
        rig = Rig()
        for number in range(7000):
            rig.robot_ns += 500_000
            who = f"stranger{number}" if many_names else "stranger"
            rig.ask(0.1, operator=f"instance-{number}", name=who, age=0.0, counter=ASK)
            if number % 40 == 0:
                rig.tick()
                rig.ask(0.1, age=0.0)
                rig.decide()
        assert ("under many" if many_names else "from stranger;") in str(rig.guard.flood)


def test_hands_and_held_keys_are_none(rig: Rig) -> None:
    assert ask(rig, 4.0, {"joystick": 50, "keyboard": 80, "script": 50}) == {""}


def test_a_flood_that_has_ended_is_told_no_more(rig: Rig) -> None:
    ask(rig, 3.5, {"stranger": 2000})
    assert rig.guard.flood
    ask(rig, 2.5, {"joystick": 50})
    assert rig.guard.flood == NO_TROUBLE


def test_many_that_come_after_a_long_silence_are_none(rig: Rig) -> None:
    """A link that was cut hands over what it has held."""
    ask(rig, 1.5, {"joystick": 50})
    rig.wait(8.0)
    for _ in range(400):
        rig.ask(0.1, age=8.0)
    assert ask(rig, 4.0, {"joystick": 50}) == {""}
