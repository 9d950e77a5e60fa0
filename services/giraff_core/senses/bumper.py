"""Bumpers: switches at the robot's rim."""

from typing import ClassVar, Literal

from giraff_core.senses.sense import Sense
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
