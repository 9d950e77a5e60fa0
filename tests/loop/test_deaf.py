"""Drives with deaf sensors, in simulated time: a part of what tests/campaign/test_deaf.py does."""

from __future__ import annotations

import pytest

from giraff_guard.obstacles import Limited, Obstacles
from giraff_schemas.messages import RobotTime
from tests.loop.deaf import run, told
from tests.loop.touches import Kind

DRIVES = {
    12: "stopped before a corner, both front deaf, backed up and on again",
    17: "towards a box, both front deaf on the way, and beyond it to a far wall",
    40: "towards a wall, both front deaf on the way",
    43: "backward towards posts, all deaf, backed up and on again",
    132: "a cluttered room, front left deaf on the way",
    74: "backward towards a wall, all deaf, a curve, a turn back and on",
    0: "turned into the open, parked, all deaf, and on to a far wall",
    338: "backward towards a slanted wall, rear deaf, turned to it squarely",
}
"""By seed. A guard that trusts a silent sensor for 5 m touches at 0.19 m/s in 132, above 0.5 m/s in all others but
338; one that takes an echo to come from the middle of the cone touches at 0.38 m/s in 338."""


@pytest.mark.parametrize("seed", DRIVES)
def test_what_a_deaf_sensor_has_heard_or_would_have_is_touched_slowly(seed: int) -> None:
    outcome = run(seed)
    assert [told(outcome, touch) for touch in outcome.breaks] == []
    assert outcome.way > 0.5


def test_the_judge_sees_what_a_guard_that_lets_all_pass_touches(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_of_it(guard: Obstacles, linear_x: float, angular_z: float, now: RobotTime) -> Limited:
        return Limited(linear_x, angular_z, "", guard._forward.relied_on(now))

    monkeypatch.setattr(Obstacles, "limit", all_of_it)
    box, far_wall = run(17).breaks
    assert (box.kind, box.surface, far_wall.kind, far_wall.surface) == (Kind.HEARD, "box", Kind.WOULD, "walls")
    assert min(box.speed, far_wall.speed) > 0.5
    assert box.is_audible
    assert far_wall.is_audible
