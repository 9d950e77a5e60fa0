"""The parts that all types of sensors have in common."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Final, NamedTuple, Protocol

import msgspec

from giraff_core.tuning import Tuning
from giraff_schemas.frames import Transform
from giraff_schemas.messages import RobotTime
from giraff_schemas.topics import Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class Sensed(Protocol):
    """A sample of a sensor that the guard listens to."""

    @property
    def sensor(self) -> str: ...
    @property
    def tick(self) -> RobotTime | None: ...
    @property
    def instance(self) -> str: ...
    @property
    def seq(self) -> int: ...


_PIECE: Final = 0.27
"""rad between two places of an arc at most: few, since pages are told them 25 times a second."""
Strip = Sequence[tuple[float, float]]
"""A line through places: x, y in m."""


class Summary(NamedTuple):
    """Content of one sample in words, for screens that know no robot file."""

    text: str
    """Short text: a distance, "clear", "pushed"."""
    nearest: float | None = None
    """m to the nearest thing, 0 where it touches; None: the sensor sees none."""
    trouble: Trouble = NO_TROUBLE
    """Cause, where the sensor itself is faulty."""


class Evidence(NamedTuple):
    """Content of one sample on the floor, for screens that draw it. All places are in `base_link`."""

    free: Sequence[Strip] = ()
    """Outlines of the floor where nothing stands."""
    seen: Sequence[Strip] = ()
    """Lines along what stands there. A line of one place is a point."""


def arc(x: float, y: float, radius: float, middle: float, half: float) -> list[tuple[float, float]]:
    """Return places on an arc about (x, y), from `half` rad to the right of `middle` to as much to the left."""
    pieces = 2 * math.ceil(half / _PIECE)
    bearings = (middle + half * (2.0 * piece / pieces - 1.0) for piece in range(pieces + 1))
    return [(x + radius * math.cos(bearing), y + radius * math.sin(bearing)) for bearing in bearings]


class Sense(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="type"):
    """A sensor of the robot file. Each type is a subclass, whose tag is the `type` in the file."""

    LIVE: ClassVar = Tuning.READ_ONLY
    TOPIC: ClassVar[Topic[Any] | None] = None
    """Topic of what it tells the guard; None: the guard does not listen to it."""

    @classmethod
    def type_name(cls) -> str:
        """Return its `type` in the robot file."""
        return str(cls.__struct_config__.tag)

    def transform(self, name: str) -> Transform | None:
        """Return where the sensor of this name is; None: it has no place."""
        del name
        return None

    @classmethod
    def summary(cls, sample: Any) -> Summary:
        """Return what a sample of its topic says."""
        del sample
        return Summary("")

    def field(self, footprint_radius: float) -> Sequence[Strip]:
        """Return outlines of the floor that it senses. They show where it tells nothing while it is faulty."""
        del footprint_radius
        return ()

    def evidence(self, sample: Any, footprint_radius: float) -> Evidence:
        """Return what a sample of its topic shows. `footprint_radius`: m, of the robot."""
        del sample, footprint_radius
        return Evidence()


class UnknownSensor(Sense, frozen=True, kw_only=True, tag="unknown"):
    """A sensor of a type that this version does not know. Users of other types pass it over."""

    named: str
    """Its `type` in the robot file."""
