"""The robot with a laser scanner, on the network."""

from collections import deque
from typing import Any, Final

from giraff_schemas.messages import Sample
from giraff_schemas.scan import LaserScan
from giraff_schemas.topics import SCAN, Topic
from giraff_setup.ultrasonic.stand import NetworkStand
from giraff_tools.network.connection import RobotConnection

_PATIENCE: Final = 3.0  # s
_TURN_EVERY: Final = 0.25  # s at most: the slowest turn takes 0.2 s
_BEGUN: Final = 2  # turns that may have begun before


class ScanStand(NetworkStand):
    """As `ScannedRobot`."""

    def __init__(self, connection: RobotConnection) -> None:
        super().__init__(connection, SCAN)
        self._scans: deque[LaserScan] = deque(maxlen=100)

    def scan(self, turns: int) -> list[LaserScan]:
        """As `ScannedRobot`."""
        self.idle()
        self._scans.clear()
        wanted = turns + _BEGUN
        self._wait(lambda: len(self._scans) >= wanted, _PATIENCE + wanted * _TURN_EVERY)
        self._require_whole()
        return list(self._scans)[_BEGUN:wanted]

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """As a `Listener`."""
        if isinstance(sample, LaserScan):
            self._scans.append(sample)
        else:
            super().on_sample(topic, key, sample, at_ns)
