"""A robot that balances: each stop takes its run-on too, and it drives off only with room behind it."""

import msgspec
import pytest

from giraff_core.senses import Bumper
from giraff_guard.stopping import stopping_distance
from giraff_schemas.bumper import Bump
from tests.unit.guard.senses import CONFIG, FAR, Senses, opened, raised, robot_with
from tests.unit.guard.senses import ROBOT as LEVEL_ROBOT

ROBOT = raised(LEVEL_ROBOT)
BALANCER = msgspec.structs.replace(CONFIG, deceleration=0.35, run_on=0.12, room_behind=0.2)
LEAST = 0.287
"""m that the rear sensor of this robot reads where 0.2 m beyond the footprint are certain."""


def test_a_stop_takes_the_run_on_besides() -> None:
    senses = opened(ROBOT, BALANCER)
    senses.cycle({"front_left": 0.7, "front_right": 0.7}, cycles=3)
    with_run_on = senses.verdict()
    assert with_run_on.clearance == "slow"
    room = stopping_distance(with_run_on.allowed, BALANCER.reaction_time, 0.35, 0.12)
    senses.live.replace(msgspec.structs.replace(BALANCER, run_on=0.0))
    without = senses.allowed()
    assert stopping_distance(without, BALANCER.reaction_time, 0.35) == pytest.approx(room, abs=0.02)
    assert with_run_on.allowed < without - 0.05


@pytest.mark.parametrize(("behind", "clearance"), [(LEAST - 0.01, "blocked"), (LEAST + 0.01, "free"), (None, "free")])
def test_an_echo_behind_blocks_the_way_ahead_and_a_silence_does_not(behind: float | None, clearance: str) -> None:
    senses = opened(ROBOT, BALANCER)
    senses.cycle({"rear": behind}, cycles=3)
    senses.hear(FAR, "front_left", "front_right")
    judged = senses.verdict()
    assert judged.clearance == clearance
    if behind is not None and clearance == "blocked":
        assert judged.reason.what == "rear sees something at 0.28 m, and the robot would first roll back towards it"
        assert (judged.sensor, judged.reason.remedy, senses.allowed("turn_left")) == (
            "rear",
            "turn",
            ROBOT.max_angular_speed,
        )
    senses.live.replace(CONFIG)
    assert senses.allowed() > 0.0, "on wheels it does not roll back"


def test_what_is_not_known_behind_is_a_reason_to_creep() -> None:
    for senses in (opened(raised(robot_with("front_left", "front_right")), BALANCER), opened(ROBOT, BALANCER)):
        if "rear" in senses.robot.sensors:
            assert senses.allowed() == ROBOT.max_wheel_speed
            senses.hear(None, "rear", fault="no board")
        assert senses.allowed() == BALANCER.creep_linear


def test_a_bumper_that_is_pushed_behind_blocks_and_one_that_is_not_heard_creeps() -> None:
    senses = opened(
        msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"back": Bumper(index=0, way="backward")}), BALANCER
    )
    assert senses.allowed() == BALANCER.creep_linear
    for pressed, allowed in ((False, ROBOT.max_wheel_speed), (True, 0.0)):
        senses.obstacles.on_sensed(Bump(sensor="back", pressed=pressed, tick=senses.now), senses.now)
        assert senses.allowed() == allowed
    assert "would first roll back towards it" in str(senses.verdict().reason)
    senses.cycle(cycles=3)
    assert senses.verdict().reason.what.startswith("back is pushed"), "its last word counts while it is silent"
    senses.obstacles.forget()
    senses.cycle(cycles=3)
    assert senses.verdict().reason.what.startswith("back was pushed here"), "in another epoch, too"


def test_the_way_opens_again_where_there_is_a_little_more_room_behind() -> None:
    """Else the noise of one sensor at the edge starts and stops the robot in turns."""

    def allowed(behind: float) -> float:
        senses.cycle({"rear": behind}, cycles=3)
        return senses.allowed()

    senses: Senses = opened(ROBOT, BALANCER)
    assert allowed(LEAST - 0.01) == 0.0
    assert allowed(LEAST + 0.01) == 0.0
    assert allowed(LEAST + 0.06) > 0.0


def test_a_robot_too_fast_to_stop_with_its_run_on_brakes() -> None:
    senses = opened(ROBOT, BALANCER)
    senses.cycle({"front_left": 0.58, "front_right": 0.58}, cycles=3)
    senses.linear = 0.3
    senses.report()
    assert senses.verdict().reason.what.endswith("braking")
    senses.live.replace(msgspec.structs.replace(BALANCER, run_on=0.0))
    assert not senses.verdict().reason.what.endswith("braking")
