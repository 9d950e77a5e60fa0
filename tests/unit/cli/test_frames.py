"""What `giraff frames` makes of transforms."""

from __future__ import annotations

import pytest

from giraff_cli.frames.tree import Frames, dot, faults_of
from giraff_schemas.frames import Transform


def frame(parent: str, child: str) -> Transform:
    return Transform(parent=parent, child=child, x=0.0, y=0.0, yaw=0.0, fixed=True)


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ([frame("odom", "base_link"), frame("base_link", "rear")], []),
        ([frame("odom", "base_link"), frame("map", "base_link")], ["in map and in odom", "map, odom are in none"]),
        ([frame("base_link", "rear")], []),
        ([frame("odom", "base_link"), frame("chassis", "rear")], ["hang together nowhere: chassis, odom"]),
        ([frame("a", "b"), frame("b", "a")], ["they are in each other"]),
    ],
)
def test_what_is_no_tree_is_told(told: list[Transform], said: list[str]) -> None:
    faults = faults_of(told)
    assert len(faults) == len(said)
    assert all(words in fault for words, fault in zip(said, faults, strict=True))


def test_a_name_may_hold_anything() -> None:
    drawn = dot(Frames(robot='a"b', frames=[frame('x"', "y\\")], faults=[]))
    assert drawn.splitlines()[0] == 'digraph "a\\"b" {'
    assert '"x\\"" -> "y\\\\"' in drawn
