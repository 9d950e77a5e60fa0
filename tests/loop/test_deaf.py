"""Drives with deaf sensors, in simulated time: a part of what tests/campaign/test_deaf.py does."""

import math

import pytest

from giraff_guard.obstacles import Limited, Obstacles
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE
from giraff_sim.world.room import Pose, Room
from tests.loop.deaf import run, run_drive, told
from tests.loop.deaf_drives import Act, Drive
from tests.loop.touches import Kind

DRIVES = {
    17: (12.0, "towards a box, both front deaf on the way"),
    43: (31.0, "backward towards posts, all deaf, backed up and on again"),
    132: (22.0, "a cluttered room, front left deaf on the way"),
    338: (8.5, "backward towards a slanted wall, rear deaf, turned to it squarely"),
}
"""By seed: until when (s), soon after what it is for. A guard that trusts a silent sensor, and holds nothing, touches
above 0.5 m/s in 17, 43 and 338, in 43 what it would have heard. One that holds 0.3 m beside the way touches at 0.19 m/s
in 338."""


@pytest.mark.parametrize("seed", DRIVES)
def test_what_a_deaf_sensor_has_heard_or_would_have_is_touched_slowly(seed: int) -> None:
    outcome = run(seed, until=DRIVES[seed][0])
    assert [told(outcome, touch) for touch in outcome.breaks] == []
    assert outcome.touches
    assert outcome.way > 0.5


@pytest.mark.parametrize(
    ("hears", "sign", "deaf", "until"),
    [("E--", 1.0, ("front_left", "front_right"), 15.0), ("E-", -1.0, ("rear",), 15.0)],
)
def test_what_a_sensor_heard_now_and_then_before_it_is_deaf_is_touched_slowly(
    hears: str, sign: float, deaf: tuple[str, ...], until: float
) -> None:
    room = Room("a wall", Pose(0.0, 0.0, 0.0 if sign > 0.0 else math.pi))
    room.add_wall("wall", [(3.0, -3.0), (3.0, 3.0)])
    drive = Drive(
        seed=0,
        room="a wall",
        deaf=deaf,
        sign=sign,
        acts=(Act("park", 3.0), Act("drive", 1.5), Act("cover"), Act("push", 15.0)),
        is_wild=False,
        keeps_heading=True,
        hears=tuple(ping == "E" for ping in hears),
    )
    outcome = run_drive(drive, room, until=until)
    assert [told(outcome, touch) for touch in outcome.breaks] == []
    assert outcome.touches
    assert outcome.touches[0].kind in (Kind.HEARD, Kind.WOULD)
    assert max(touch.speed for touch in outcome.touches) < 0.16


def test_the_judge_sees_what_a_guard_that_lets_all_pass_touches(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_of_it(guard: Obstacles, linear_x: float, angular_z: float, now: RobotTime) -> Limited:
        return Limited(linear_x, angular_z, NO_TROUBLE, guard._directions["forward"].relied_on(now))

    monkeypatch.setattr(Obstacles, "limit", all_of_it)
    box, far_wall = run(17).breaks
    assert (box.kind, box.surface, far_wall.kind, far_wall.surface) == (Kind.HEARD, "box", Kind.WOULD, "walls")
    assert min(box.speed, far_wall.speed) > 0.5
    assert box.is_audible
    assert far_wall.is_audible
