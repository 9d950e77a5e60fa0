"""The scan: packets of a laser scanner to `scan/<sensor>`, a sample a turn."""

import math
from array import array
from typing import Final

from giraff_core.fresh_bytes import FreshBytes
from giraff_core.io import IO
from giraff_core.kinematics.pose_history import FrameError, PoseHistory
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_scan.clock import LATE_NS, DeviceClock
from giraff_scan.config import ScanConfig, scanner_of
from giraff_scan.ld19 import BAUD, cut_packets
from giraff_scan.policy import Turn, Turns
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NOT_MEASURED, RAYS, LaserScan, packed, scan_frame
from giraff_schemas.topics import ODOM, SCAN, TICK
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_DELAY: Final = 0.022
"""s from the first point of a packet until its bytes begin to arrive: 3 ms, and 16 ms in an adapter."""
_SILENT_NS: Final = LATE_NS
_TOLD_EVERY_NS: Final = 100_000_000
_NOTHING: Final = array("H", [NOT_MEASURED]) * RAYS
_SILENT: Final = Trouble("says nothing that counts", "check its cable and its 5 V")
_LATE: Final = Trouble("its packets come more than 0.15 s late", "plug it into another port of this computer")
_REPEATS: Final = Trouble("says the same again", "take its power away for a moment")


class Scan:
    """Reads the scanner, `tick` and `odom`; writes `scan/<sensor>`."""

    link = None

    def __init__(self, io: IO, config: ScanConfig, robot: RobotConfig) -> None:
        self._io, self._name = io, config.name
        self.timers = (Timer(50.0),)
        self._scanner = scanner_of(config, robot)
        self._ticks, self._odometry = io.inbox(TICK, wakes=False), io.inbox(ODOM, wakes=False)
        self._history = PoseHistory()
        self._port = io.serial(config.port, BAUD)
        self._fresh = FreshBytes(self._port, io.robot_ns, delay=_DELAY)
        self._clock, self._turns = DeviceClock(), Turns(self._scanner)
        self._newest: RobotTime | None = None
        """Newest tick that has come."""
        self._heard_ns = io.robot_ns()
        """Robot's time of the newest packet that counts."""
        self._late, self._repeated = 0, 0
        """Packets that had been dropped at the last turn."""
        self._told_ns = 0
        """Robot's time at which a fault was told last; 0: there is none."""
        self._scans = io.publisher(SCAN.at(config.name))
        io.frame(scan_frame(config.name), self._scanner.transform(config.name))

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        ticks = list(self._ticks.pop_all())
        for tick in ticks:
            self._newest = tick.time
        for odometry in self._odometry.pop_all():
            self._history.on_odometry(odometry)
        self._fresh.update(now, ticks)
        now_ns = self._io.robot_ns()
        for packet, tick_before in cut_packets(self._fresh):
            if packet is None:
                self._turns.on_damaged()
            elif (measured_ns := self._clock.measured_ns(packet.ms, now_ns)) is not None:
                self._heard_ns = measured_ns
                if (turn := self._turns.add(packet, measured_ns, tick_before)) is not None:
                    self._say(turn)
        self._report(now_ns)

    def end(self) -> None:
        """Nothing is left to say: the guard judges silence."""

    def _say(self, turn: Turn, trouble: Trouble = NO_TROUBLE) -> None:
        """Publish a turn. Its tick is no newer than its first ray."""
        if turn.tick is None:
            return
        tick = RobotTime(turn.tick.epoch, min(turn.tick.robot_ns, turn.begun_ns))
        step = math.tau / RAYS
        try:
            odom = self._history.at(RobotTime(tick.epoch, turn.begun_ns))
        except FrameError:
            odom = None
        self._scans.put(
            LaserScan(
                sensor=self._name,
                ranges=packed(turn.ranges),
                bearing=self._scanner.yaw,
                step=step if self._scanner.upside_down else -step,
                duration=turn.duration,
                since_tick=(turn.begun_ns - tick.robot_ns) * 1e-9,
                odom=odom,
                blind=turn.blind,
                trouble=trouble,
                tick=tick,
            )
        )

    def _report(self, now_ns: int) -> None:
        """Say at once that the scanner itself is faulty, and then as often as it would say a turn."""
        clock = self._clock
        late, self._late = clock.late > self._late, clock.late
        repeats, self._repeated = clock.repeated > self._repeated, clock.repeated
        trouble = self._turns.fault
        if now_ns - self._heard_ns > _SILENT_NS:
            trouble = _REPEATS if repeats else _LATE if late else _SILENT
        self._io.set_fault("port", self._port.fault)
        trouble = trouble.of(self._name) if trouble else trouble
        self._io.set_fault(self._name, trouble)
        if not trouble:
            self._told_ns = 0
        elif now_ns - self._told_ns >= _TOLD_EVERY_NS:
            self._told_ns = now_ns
            self._say(Turn(_NOTHING, (), now_ns, 0.0, self._newest), trouble)
