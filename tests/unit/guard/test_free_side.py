"""The side to which a balancing robot may sit down: only where sensors know now that there is room."""

import msgspec

from giraff_schemas.bumper import Bump
from tests.unit.guard.rig import Rig
from tests.unit.guard.senses import CONFIG, CYCLE, ROBOT, Senses, opened, robot_with
from tests.unit.guard.test_bumper import BUMPED

CLOSE = 0.38
"""m from a sensor of this robot: blocks no way, and leaves less than `sit_room`."""


def side(senses: Senses) -> str:
    senses.judge()
    return senses.obstacles.free_side(senses.now)


def test_it_is_forward_where_both_are_free_and_none_where_neither_is(senses: Senses) -> None:
    assert side(senses) == "forward"
    senses.cycle({"front_left": CLOSE}, cycles=2)
    assert side(senses) == "backward"
    senses.cycle({"front_left": CLOSE, "rear": CLOSE}, cycles=2)
    assert senses.allowed("forward") > 0.0
    assert side(senses) == "none"


def test_a_side_of_which_nothing_is_known_is_not_free() -> None:
    assert side(Senses()) == "none", "nothing has been heard"
    assert side(opened(robot_with("rear"))) == "backward"
    senses = opened(robot_with("front_left", "front_right"))
    assert side(senses) == "forward"
    senses.hear(None, "front_left", fault="no board")
    assert side(senses) == "none", "nothing looks backward"
    senses = opened()
    senses.wait(CONFIG.range_budget + CYCLE)
    assert side(senses) == "none", "all ranges are old"


def test_a_silence_that_is_not_proved_is_not_free(senses: Senses) -> None:
    senses.cycle(None, cycles=2)
    assert side(senses) == "forward"
    senses.cycle(None, cycles=round(CONFIG.trust_full_time / CYCLE) + 1)
    assert senses.allowed("forward") > 0.0
    assert side(senses) == "none"


def test_what_was_heard_until_lately_counts(senses: Senses) -> None:
    senses.cycle({"front_left": CLOSE, "front_right": CLOSE}, cycles=3)
    senses.cycle({"front_left": None, "front_right": None}, cycles=2)
    assert side(senses) == "backward"


def test_a_pushed_bumper_takes_its_side() -> None:
    senses = opened(BUMPED)
    assert side(senses) == "backward", "the bumper has not been heard"
    for pressed, free in ((False, "forward"), (True, "backward")):
        bump = Bump(sensor="front", pressed=pressed, tick=senses.now)
        senses.obstacles.on_sensed(bump, senses.now)
        assert side(senses) == free


def test_more_room_can_be_asked_for() -> None:
    assert side(opened(ROBOT, msgspec.structs.replace(CONFIG, sit_room=2.9))) == "none"


def test_the_guard_tells_it_with_each_command_and_not_where_two_guards_speak(rig: Rig) -> None:
    rig.look()
    assert rig.decide()[0].free_side == "forward"
    rig.hear(ranger="ranger-2")
    rig.hear(ranger="ranger-2")
    command, _ = rig.decide()
    assert (command.source, command.free_side) == ("fault", "none")
