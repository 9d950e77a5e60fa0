"""What a sensor sees one way: the speed from which the robot stops before it."""

import math
from operator import attrgetter
from typing import Final, NamedTuple

from giraff_guard.limits import Limits
from giraff_guard.source import Reading, Sight
from giraff_schemas.messages import DirectionLimit
from giraff_schemas.trouble import Trouble

_ROLLS: Final = "the robot would first roll back towards it"


class _ReadingLimit(NamedTuple):
    """What one reading allows."""

    allowed: float
    """m/s; 0 where it blocks."""
    reading: Reading
    is_braking: bool = False
    """It blocks because the robot is faster than it may be."""


class Nearest:
    """Judges what one sensor tells of a direction."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits

    def verdict(self, sight: Sight, age: float, stops_within: float, *, blocked: bool) -> DirectionLimit:
        """Return what one sensor allows.

        `age`: s of its newest reading. `stops_within`: m. `blocked`: the way was blocked, and needs more room to be
        opened again.
        """
        limits, config = self._limits, self._limits.config
        if why := sight.blind or sight.touch:
            return limits.block(sight.sensor, why)
        # The newest first, so that of equal ones it is the one named.
        judged = [
            self._by_reading(reading, None if number else age, stops_within, blocked=blocked)
            for number, reading in enumerate(sight.readings)
        ]
        nearest = min(judged, key=attrgetter("allowed"), default=None)
        verdict = self._verdict_of(sight.sensor, nearest) if nearest is not None else limits.allow(limits.most)
        if verdict.allowed <= config.creep_linear or not sight.doubt:
            return verdict
        if sight.doubtful_speed < verdict.allowed:
            return limits.allow(sight.doubtful_speed, sight.sensor, sight.doubt)
        return verdict

    def room(self, sight: Sight) -> float:
        """Return m beyond the footprint that one sensor knows to be free. Without proof, its silence tells nothing."""
        if sight.blind or sight.touch or sight.doubt:
            return 0.0
        return min((reading.gap - reading.came for reading in sight.readings), default=math.inf)

    def opposite(self, sight: Sight, *, blocked: bool) -> DirectionLimit | None:
        """Limit the other way by one sensor of this way, to which the robot first rolls back; None: not at all.

        `blocked`: this sensor blocked it last. A silence limits nothing.
        """
        limits, config = self._limits, self._limits.config
        if sight.blind and not sight.touch:
            return limits.creep(sight.sensor, sight.blind)
        echoes = [reading for reading in sight.readings if reading.is_echo]
        room = min((reading.gap - reading.came for reading in echoes), default=math.inf)
        if room < config.room_behind + (config.release if blocked else 0.0):
            seen = min(reading.distance for reading in echoes)
            return limits.block(sight.sensor, Trouble(f"{sight.sensor} sees something at {seen:.2f} m, and {_ROLLS}"))
        if sight.touch:
            return limits.block(sight.sensor, Trouble(f"{sight.touch.what}, and {_ROLLS}"))
        return None

    def _by_reading(self, reading: Reading, age: float | None, stops_within: float, *, blocked: bool) -> _ReadingLimit:
        """Return what one reading allows. `age`: s of the newest; None: it is an earlier one."""
        limits, config = self._limits, self._limits.config
        room, came = reading.gap - config.margin, reading.came
        allowed = limits.fastest(room - came)
        if age is not None:
            # As if it had gone on at that speed since the reading, whatever the wheels say.
            allowed = min(allowed, limits.fastest(room, age))
        too_close = room - came < config.release if blocked else room <= 0.0
        if too_close or allowed < config.min_speed:
            return _ReadingLimit(0.0, reading)
        if came + stops_within > room:
            # The robot is faster than it may be: power off brakes harder than a lower level does.
            return _ReadingLimit(0.0, reading, is_braking=True)
        return _ReadingLimit(min(allowed, limits.most), reading)

    def _verdict_of(self, sensor: str, limit: _ReadingLimit) -> DirectionLimit:
        what = "sees something at" if limit.reading.is_echo else "sees no farther than"
        seen = f"{sensor} {what} {limit.reading.distance:.2f} m{', braking' if limit.is_braking else ''}"
        if limit.allowed > 0.0:
            return self._limits.allow(limit.allowed, sensor, Trouble(seen))
        return self._limits.block(sensor, Trouble(seen))
