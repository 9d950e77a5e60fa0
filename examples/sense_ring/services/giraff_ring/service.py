"""The ring: packets of an Arduino to `ring/<name>`."""

from typing import Final

from giraff_core.fresh_bytes import FreshBytes
from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_ring.config import RingConfig
from giraff_ring.policy import distances, packet_length
from giraff_schemas.ring import RingLook
from giraff_schemas.topics import RING, TICK

_DELAY: Final = 0.06
"""s from the beginning of a measurement, of which a sensor makes one in 40 ms, until its packet begins to arrive."""


class Ring:
    """Reads the Arduino and `tick`; writes `ring/<name>`. While the Arduino is silent so is this service."""

    link = None

    def __init__(self, io: IO, config: RingConfig, robot: RobotConfig) -> None:
        del robot  # a packet is the same wherever the ring sits
        self._io, self._name = io, config.name
        self.timers = (Timer(50.0),)
        self._ticks = io.inbox(TICK, wakes=False)
        self._port = io.serial(config.port, 115_200)
        self._fresh = FreshBytes(self._port, io.robot_ns, delay=_DELAY)
        self._looks = io.publisher(RING.at(config.name))

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        self._fresh.update(now, self._ticks.pop_all())
        while length := packet_length(self._fresh.data):
            packet, tick = self._fresh.cut(length)
            if (found := distances(packet)) is not None:
                self._looks.put(RingLook(sensor=self._name, distances=found, tick=tick))
        self._io.set_fault("port", self._port.fault)

    def end(self) -> None:
        """Nothing is left to say: the guard judges silence."""
