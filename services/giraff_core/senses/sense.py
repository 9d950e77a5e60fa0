"""The parts that all types of sensors have in common."""

from typing import Any, ClassVar, Protocol

import msgspec

from giraff_core.tuning import Tuning
from giraff_schemas.frames import Transform
from giraff_schemas.messages import RobotTime
from giraff_schemas.topics import Topic


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


class UnknownSensor(Sense, frozen=True, kw_only=True, tag="unknown"):
    """A sensor of a type that this version does not know. Users of other types pass it over."""

    named: str
    """Its `type` in the robot file."""
