"""Bumpers: switches at the robot's rim."""

import math
from typing import ClassVar, Literal

from giraff_core.senses.sense import Evidence, Sense, Strip, Summary, arc
from giraff_schemas.bumper import Bump
from giraff_schemas.topics import BUMPER, Topic
from giraff_schemas.wires.bumper import BUMPERS


class Bumper(Sense, frozen=True, kw_only=True, tag="bumper"):
    """A switch at the robot's rim that opens when something pushes it, on a spare pin of the ranger's board."""

    TOPIC: ClassVar[Topic[Bump]] = BUMPER

    index: int
    """Number of the pin on the ranger board."""
    way: Literal["forward", "backward"]
    """The way that the robot drives when it meets something with it."""

    def __post_init__(self) -> None:
        if not 0 <= self.index < BUMPERS:
            raise ValueError(f"index is {self.index}: the ranger board has bumpers 0..{BUMPERS - 1}")

    @classmethod
    def summary(cls, sample: Bump) -> Summary:
        """Return whether something pushes it."""
        return Summary("pushed", 0.0) if sample.pressed else Summary("free")

    def field(self, footprint_radius: float) -> list[Strip]:
        """Return its part of the robot's rim."""
        return [arc(0.0, 0.0, footprint_radius, 0.0 if self.way == "forward" else math.pi, math.pi / 3.0)]

    def evidence(self, sample: Bump, footprint_radius: float) -> Evidence:
        """Return its part of the robot's rim."""
        rim = self.field(footprint_radius)
        return Evidence(seen=rim) if sample.pressed else Evidence(free=rim)
