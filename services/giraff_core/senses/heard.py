"""Sensors as a tool hears them that has no robot file."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final, NamedTuple

from giraff_core.latest import Latest
from giraff_core.senses import SENSED, Sense, Summary
from giraff_schemas.topics import Topic

_BY_TYPE: Final = {sense.type_name(): sense for sense in SENSED}


class HeardSensor(NamedTuple):
    """A sensor that the guard listens to."""

    sense: type[Sense]
    key: str
    """Key of its samples, below the robot's name."""
    newest: Latest[Any] | None
    """None: it was never heard."""

    @property
    def summary(self) -> Summary | None:
        """Return what it says now. None: it is silent."""
        return None if self.newest is None or not self.newest.fresh else self.sense.summary(self.newest.sample)


def heard_sensors(
    types: Mapping[str, str], newest: Callable[[Topic[Any]], Iterable[Latest[Any]]]
) -> dict[str, HeardSensor]:
    """Return by name the sensors of `types`, in that order, and then all others that are heard.

    `types`: by name, as the guard or the robot file tells them. `newest`: the samples of a topic.
    """
    found = {name: _sensor(_BY_TYPE[kind], name) for name, kind in types.items() if kind in _BY_TYPE}
    for sense, topic in SENSED.items():
        for each in sorted(newest(topic), key=lambda each: (each.sample.sensor, -each.age)):
            name = each.sample.sensor
            if found.setdefault(name, _sensor(sense, name)).sense is sense:
                found[name] = found[name]._replace(newest=each)
    return found


def _sensor(sense: type[Sense], name: str) -> HeardSensor:
    return HeardSensor(sense, SENSED[sense].key.replace("*", name), None)
