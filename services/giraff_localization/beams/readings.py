"""Readings of the sensors since the last update, each where it was heard."""

import math
from collections import deque
from collections.abc import Mapping
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Ultrasonic
from giraff_localization.beams.range_table import CLEAR
from giraff_localization.beams.ultrasonic import Beam, Sonars
from giraff_localization.track import Track
from giraff_schemas.messages import Range, RobotTime

_EXPONENT: Final = 0.2
"""By which all readings of one sensor on one piece of way count together. Each for itself would count the map's small
errors again and again: the filter would be sure, and wrong."""
_DEAF: Final = 2.5
"""m, turns counted, without an echo: the sensor is deaf, or in the open. Its silence says nothing until it hears."""
_KEPT: Final = 12
"""Of a sensor, the newest: a robot that stands hears the same again and again."""
_WAITING: Final = 100
"""Readings of which odometry has not told yet where they were taken."""


class Readings:
    """Readings of all sensors that the robot file names."""

    def __init__(self, sensors: Mapping[str, Ultrasonic], sonars: Sonars) -> None:
        self._sonars = sonars
        self._mounts = {name: Pose(mount.x, mount.y, mount.yaw) for name, mount in sensors.items()}
        self._waiting: deque[tuple[RobotTime, str, int]] = deque(maxlen=_WAITING)
        self._heard: dict[str, deque[tuple[Pose, int]]] = {name: deque(maxlen=_KEPT) for name in sensors}
        self._silent = dict.fromkeys(sensors, 0.0)

    def on_range(self, reading: Range) -> None:
        """Take one; a fault says nothing, nor does what nobody can date."""
        if reading.sensor in self._mounts and reading.state != "fault" and reading.tick is not None:
            self._waiting.append((reading.tick, reading.sensor, self._in_bins(reading)))

    def place(self, way: Track) -> None:
        """Put those to their places that odometry has reached."""
        for _ in range(len(self._waiting)):
            tick, sensor, heard = self._waiting.popleft()
            if way.is_ahead(tick):
                self._waiting.append((tick, sensor, heard))
            elif (pose := way.at(tick)) is not None:
                self._heard[sensor].append((pose, heard))

    def pop_beams(self, here: Pose, effort: float) -> list[Beam]:
        """Those since the last time, as seen from the robot where it is now; `effort`: m it has come, turns counted."""
        beams = []
        for sensor, heard in self._heard.items():
            if not heard:
                continue
            if all(reading == CLEAR for _, reading in heard):
                self._silent[sensor] += effort
            else:
                self._silent[sensor] = 0.0
            if self._silent[sensor] <= _DEAF:
                share = _EXPONENT / len(heard)
                for pose, reading in heard:
                    place = self._mounts[sensor].placed_in(pose).seen_from(here)
                    beams.append(Beam(place.x, place.y, place.yaw, reading, share, self._sonars.kinds[sensor]))
            heard.clear()
        return beams

    def _in_bins(self, reading: Range) -> int:
        model = self._sonars.models[self._sonars.kinds[reading.sensor]]
        if reading.range is None or reading.range >= model.reach:
            return CLEAR
        return min(CLEAR - 1, max(0, math.floor(reading.range / model.table.bin)))
