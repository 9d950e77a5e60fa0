"""Gateway: lines of any Arduino to `serial/<name>`, and `serial_write/<name>` to the Arduino.

Two keys, because who publishes and subscribes on one would hear itself, and because access is granted by key: to read a
sensor is not to switch a relay.
"""

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_gateway.config import GatewayConfig
from giraff_gateway.policy import LineSplitter, TimedNotices, WriteQueue, wrong_with
from giraff_schemas.topics import SERIAL, SERIAL_WRITE
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TOLD_FOR = 10.0  # s


class Gateway:
    """Publishes all that the board prints, however long it has waited: its lines measure nothing of the robot."""

    timers = ()

    def __init__(self, io: IO, config: GatewayConfig, robot: RobotConfig) -> None:
        del robot  # the board is a user's own
        self._io = io
        self._config = config
        self.link = io.serial(config.port, config.baud)
        self._splitter = LineSplitter(config.name, config.longest_line)
        self._queue = WriteQueue(config.longest_line, config.ending)
        self._passing = TimedNotices(_TOLD_FOR, "utf-8", "length", "write")
        self._lines, self._writes = io.publisher(SERIAL.at(config.name)), io.inbox(SERIAL_WRITE.at(config.name))

    def turn(self, now: float) -> None:
        config, passing = self._config, self._passing
        arrival = self.link.poll(now)
        if arrival.opened:
            self._splitter = LineSplitter(config.name, config.longest_line)  # what was begun was another life's
        for line in self._splitter.feed(arrival.data):
            self._lines.put(line)
            for name, trouble in wrong_with(line, config).items():
                passing.report(name, trouble, now)
        for asked in self._writes.pop_all():
            passing.report("write", self._queue.put(asked.text), now)
        passing.report("write", self._write(), now)
        for name, trouble in passing.now(now).items():
            self._io.set_notice(name, trouble)
        self._io.set_fault("port", self.link.fault)

    def end(self) -> None:
        """Nothing is left to say."""

    def _write(self) -> Trouble:
        """Go on writing what waits; return why it was lost."""
        if self.link.fault:
            return self.link.fault.of("texts were not written") if self._queue.drop() else NO_TROUBLE
        while self.link.is_idle and (data := self._queue.pop()):
            self.link.send(data)
        return NO_TROUBLE
