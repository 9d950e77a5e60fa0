"""Whether a sensor's readings are those of a surface, judged by how the robot has moved."""

from collections import deque
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_guard.config import GuardConfig

_SAME_US: Final = 8
"""µs, 1.4 mm: two pulses that differ by no more are the same; the board times edges to 4 µs."""
_PAIRS: Final = 16
_TOO_MANY: Final = 12
"""Jumps among so many readings. Any range at all gives 14 of 16, one wild reading in twenty 1, and a wall so slanted
that it is heard now and then, about 5."""
_FEW: Final = 6
"""Jumps at which a sensor is trusted again."""


class SelfTest:
    """Of one sensor. Feed it each reading taken while the wheels are heard."""

    def __init__(self, live: Live[GuardConfig]) -> None:
        self._live = live
        self._held: tuple[int, Pose] | None = None
        self._readings_held = 0
        self._jumps: deque[bool] = deque(maxlen=_PAIRS)
        self.frozen = False
        """The same pulse again and again, though the robot moved along the sensor's axis."""
        self.wild = False
        """Most readings jump farther than the robot's motion and a person's walk explain."""

    def on_reading(self, echo_us: int | None, place: Pose, axis: float, jumped: bool) -> None:
        """`echo_us`: None where nothing answered. `jumped`: it does not follow from the reading before."""
        self._jumps.append(jumped)
        count = sum(self._jumps)
        self.wild = count > _FEW if self.wild else count >= _TOO_MANY
        held = self._held
        if echo_us is None or held is None or abs(echo_us - held[0]) > _SAME_US:
            self._held = (echo_us, place) if echo_us is not None else None
            self._readings_held = 1
            self.frozen = False
            return
        self._readings_held += 1
        if self._readings_held >= 3 and abs(held[1].ahead(place, axis)) >= self._live.config.frozen_travel:
            self.frozen = True
