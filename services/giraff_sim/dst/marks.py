"""Rare paths that seeds ought to reach: a suite that never got there has shown nothing about them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from giraff_sim.dst.simulated_run import Kind

MARKS: Final = (
    "stop: forward blocked",
    "stop: backward blocked",
    "stop: forward slowed",
    "stop: slowed",
    "stop: no fresh command",
    "stop: the guard is not heard",
    "stop: the guard's command is too old",
    "stop: a range that this motion relies on is too old",
    "stop: a second guard",
    "stop: a second base",
    "stop: a second ranger",
    "stop: another ranger",
    "stop: the base board is in state command_timeout",
    "stop: emergency stop by the base board",
    "stop: emergency stop by keyboard",
    "stop: not armed since the left wheel was held",
    "stop: emergency stop by battery",
    "answer: stopped",
    "answer: released",
    "answer: the emergency stop was engaged anew meanwhile",
    "answer: the disk hangs",
    "answer: the robot is stopped, and a restart may not know",
    "answer: latch N is not the one engaged",
    "answer: the reset is not from within the last",
    "an emergency stop was lost with its base",
    "the same engages the emergency stop anew",
    "the joystick's button is pressed while the robot drives",
    "parameter: set",
    "parameter: refused",
    "parameter: saved",
    "parameter: not saved",
)
"""Beginnings of what a run counts, beside a fault of each kind."""


def unreached(counts: Mapping[str, int], kinds: tuple[Kind, ...]) -> list[str]:
    """Of these marks and kinds of fault, those that nothing counted begins with."""
    wanted = (*(f"fault: {kind.name}" for kind in kinds), *MARKS)
    return [mark for mark in wanted if not any(what.startswith(mark) for what in counts)]
