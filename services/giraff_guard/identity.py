"""Whose samples count: one base, and one service for each sensor."""

from typing import Final

import msgspec

from giraff_core.freshness import age
from giraff_core.robot import RobotConfig
from giraff_core.senses import PUBLISHERS, Sensed
from giraff_guard.config import GuardConfig
from giraff_schemas.messages import Attitude, RobotTime, Tick, Wheels
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_NOT_ITS_CLOCK: Final = Trouble(
    "base's ticks are late or of another machine's clock", "run giraff_guard on base's machine, unburdened"
)
_NO_BASE: Final = Trouble("base is not heard", "start giraff_base on this machine")


class BoundPublisher:
    """The one process that is listened to for one thing.

    Only samples with a fresh tick are shown to it: what a dead process once said, arriving late, is nobody's voice.
    """

    def __init__(self, what: str, silence: float) -> None:
        self.publisher = ""
        """Instance in charge; empty: none yet."""
        self._what = what
        self._silence = silence
        self._seq = -1
        self._heard_ns = 0
        self._fault = NO_TROUBLE
        self._fault_ns = 0

    def admit(self, publisher: str, seq: int, robot_ns: int) -> bool:
        """Whether a fresh sample counts. Another publisher takes over once the one in charge is silent."""
        if publisher != self.publisher:
            if self.publisher and not self.silent(robot_ns):
                second = f"a second {self._what}, {publisher}, speaks beside {self.publisher}"
                self._report(Trouble(second, "end one of the two"), robot_ns)
                return False
            if self.publisher:
                another = f"another {self._what}, {publisher}, took the place of {self.publisher}"
                self._report(Trouble(another, action="hold_level"), robot_ns)
            self.publisher, self._seq = publisher, -1
        if seq <= self._seq:
            return False
        self._seq = seq
        self._heard_ns = robot_ns
        return True

    def silent(self, robot_ns: int) -> bool:
        """The publisher in charge has not been heard for so long that it may be replaced."""
        return (robot_ns - self._heard_ns) * 1e-9 > self._silence

    def fault(self, robot_ns: int) -> Trouble:
        """Why the robot must not move and be armed anew, by what was seen lately."""
        return self._fault if (robot_ns - self._fault_ns) * 1e-9 <= self._silence else NO_TROUBLE

    def _report(self, fault: Trouble, robot_ns: int) -> None:
        self._fault, self._fault_ns = fault, robot_ns


class Identity:
    """Judges each sample by its publisher, its sequence number and its tick.

    `robot_ns` is this process's own reading of the clock that base's ticks are made of. A tick only ever makes
    something as old as it is: one that lies ahead of that clock, or behind one already heard, is not taken.
    """

    def __init__(self, config: GuardConfig, robot: RobotConfig) -> None:
        self._silence = config.publisher_timeout
        self._base = BoundPublisher("base", config.publisher_timeout)
        self._sensors = {
            name: BoundPublisher(f"{PUBLISHERS[type_]} for {name}", config.publisher_timeout)
            for name, type_ in robot.sensor_types.items()
        }
        self._tick: Tick | None = None
        self._report_seqs: dict[type[Wheels | Attitude], int] = {}
        self._foreign_ns: int | None = None
        self._unproven: dict[str, int] = {}

    @property
    def tick(self) -> RobotTime | None:
        """The newest moment that base has told; None before the first."""
        return self._tick.time if self._tick is not None else None

    def now(self, robot_ns: int) -> RobotTime:
        """The moment to judge ages by. Before base is heard nothing is fresh: epoch 0 is nobody's."""
        return RobotTime(epoch=self._tick.epoch if self._tick is not None else 0, robot_ns=robot_ns)

    def on_tick(self, tick: Tick, robot_ns: int) -> bool:
        """Take a tick. True: it is another base's than before, in whose epoch nothing is known yet."""
        if not self._fresh(tick.time, RobotTime(epoch=tick.epoch, robot_ns=robot_ns)):
            self._foreign_ns = robot_ns
            return False
        if not self._base.admit(f"{tick.instance}/{tick.epoch}", tick.seq, robot_ns):
            return False
        held = self._tick
        if held is None or (held.instance, held.epoch) != (tick.instance, tick.epoch):
            self._tick = tick
            self._report_seqs.clear()
            return True
        if tick.robot_ns > held.robot_ns:
            self._tick = tick
        return False

    def admits_sensed(self, reading: Sensed, robot_ns: int) -> bool:
        """Whether a reading counts."""
        bound = self._sensors.get(reading.sensor)
        if bound is None:
            return False
        if not self._fresh(reading.tick, self.now(robot_ns)):
            self._unproven[reading.sensor] = robot_ns
            return False
        return bound.admit(reading.instance, reading.seq, robot_ns)

    def admits_report(self, report: Wheels | Attitude, robot_ns: int) -> bool:
        """Whether a report of the wheels or of the lean counts: base's own only."""
        last_seq = self._report_seqs.get(type(report), -1)
        if self._tick is None or report.instance != self._tick.instance or report.seq <= last_seq:
            return False
        if not self._fresh(report.tick, self.now(robot_ns)):
            return False
        self._report_seqs[type(report)] = report.seq
        return True

    def fault(self, robot_ns: int) -> Trouble:
        """Two of what there may be one of, or one replaced: the robot must be armed anew."""
        found = [fault for bound in (self._base, *self._sensors.values()) if (fault := bound.fault(robot_ns))]
        *others, last = found or [NO_TROUBLE]
        return msgspec.structs.replace(last, what="; ".join([*map(str, others), last.what]))

    def base_fault(self, robot_ns: int) -> Trouble:
        """Why base's clock is not known now."""
        if self._tick is not None and not self._base.silent(robot_ns):
            return NO_TROUBLE
        if self._foreign_ns is not None and self._lately(self._foreign_ns, robot_ns):
            return _NOT_ITS_CLOCK
        return _NO_BASE

    def sensor_faults(self, robot_ns: int) -> dict[str, Trouble]:
        """By sensor: why its readings do not count now, although they come."""
        faults = {}
        for name, bound in self._sensors.items():
            if fault := bound.fault(robot_ns):
                faults[name] = fault
            elif bound.silent(robot_ns) and name in self._unproven and self._lately(self._unproven[name], robot_ns):
                stale = f"{name}'s readings carry no fresh moment of this robot's clock"
                faults[name] = Trouble(stale, "check that it hears base")
        return faults

    def _fresh(self, tick: RobotTime | None, now: RobotTime) -> bool:
        return age(tick, now) <= self._silence

    def _lately(self, at_ns: int, robot_ns: int) -> bool:
        return (robot_ns - at_ns) * 1e-9 <= self._silence
