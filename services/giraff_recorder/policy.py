"""What the flight recorder remembers, what makes it write, and which files then go. No I/O, no clock."""

from collections import deque
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from giraff_mcap.raw_sample import RawSample, row_of
from giraff_recorder.config import RecorderConfig
from giraff_schemas.health import Health
from giraff_schemas.messages import BaseState, EStop
from giraff_schemas.services import ANSWERING, WATCHED
from giraff_schemas.text import brief
from giraff_schemas.trouble import Trouble

_OVERHEAD: Final = 300
"""bytes that a sample in memory takes beside its payload."""
_LARGEST: Final = 8
"""Times the usual size of a row. A larger sample is not one of the robot's services."""
_NAMES: Final = 4
"""Sensors or operators that speak on the keys of one row."""
_ON_CHANGE_HZ: Final = 10.0
"""Rate of a row that has none."""
_FOREIGN_SHARE: Final = 0.25
"""Part of the memory that samples of other keys keep. They may use more while the robot's own leave it free."""
_SERIES: Final = 7 * 86_400.0
"""s before the newest file in which the first file of a kind is kept."""
_PROCESSES: Final = 8
"""Processes of one service whose faults are remembered: a restart is another one, and two may run at once."""
_QUESTIONS: Final = 3.0
"""Questions that a process may leave unanswered until its faults count as gone with it."""
_ARMED_LATELY: Final = 2.0  # s
_LONGEST_TEXT: Final = 1000
"""Characters of an event: a stop has two texts of others, and a service may have many faults."""
_GRAVEST_FIRST: Final = ("estop", "board", "gone", "fault")
"""Kinds of events. The gravest in a file gives it its name: whoever looks for an emergency stop finds it by name."""


class Memory:
    """The newest samples: those of the last while, and never more than so many bytes.

    Anybody on an open network may put samples on any key. Samples that the robot does not send by itself share a part
    of the memory. Each row of the topics table has a share by its rate and size, so that a flood on one of its keys
    pushes out samples of that row alone.
    """

    def __init__(self, config: RecorderConfig) -> None:
        self._span_ns = round((config.before + config.after) * 1e9)
        self._most = config.memory
        self._foreign = _Part(1.0)
        self._own: dict[str, _Part] = {}
        """By the key of a row of the topics table."""

    def add(self, samples: Iterable[RawSample]) -> None:
        """Remember these, and forget what is too old or too much."""
        newest_ns = 0
        for sample in samples:
            self._part_of(sample).add(sample)
            newest_ns = sample.at_ns
        for part in self._parts():
            part.forget_before(newest_ns - self._span_ns)
        excess = sum(part.bytes for part in self._parts()) - self._most
        while excess > 0:
            is_foreign = self._foreign.bytes > self._most * _FOREIGN_SHARE
            part = self._foreign if is_foreign else max(self._own.values(), key=lambda part: part.seconds)
            excess -= part.forget_oldest()

    def since(self, at_ns: int) -> list[RawSample]:
        """Return the samples that came after `at_ns` (time.monotonic_ns), oldest first."""
        kept = (sample for part in self._parts() for sample in part.samples)
        return sorted((sample for sample in kept if sample.at_ns > at_ns), key=lambda sample: sample.at_ns)

    def _parts(self) -> "list[_Part]":
        return [self._foreign, *self._own.values()]

    def _part_of(self, sample: RawSample) -> "_Part":
        row = row_of(sample.key)
        if row is None or len(sample.payload) > _LARGEST * row.size:
            return self._foreign
        if (part := self._own.get(row.key)) is None:
            rate = (row.rate_hz or _ON_CHANGE_HZ) * (_NAMES if "*" in row.key else 1)
            part = self._own[row.key] = _Part(rate * (row.size + _OVERHEAD))
        return part


class _Part:
    """Samples of one share, oldest first."""

    def __init__(self, pace: float) -> None:
        """`pace`: bytes a second that come where nobody floods it."""
        self.samples: deque[RawSample] = deque()
        self.bytes = 0
        self._pace = pace

    @property
    def seconds(self) -> float:
        """Time in which so many bytes come at the usual pace."""
        return self.bytes / self._pace

    def add(self, sample: RawSample) -> None:
        self.samples.append(sample)
        self.bytes += _size(sample)

    def forget_oldest(self) -> int:
        """Return the bytes that are free now."""
        freed = _size(self.samples.popleft())
        self.bytes -= freed
        return freed

    def forget_before(self, at_ns: int) -> None:
        while self.samples and self.samples[0].at_ns < at_ns:
            self.forget_oldest()


class Incident(NamedTuple):
    """What is to be written now."""

    kind: str
    """In a word, for the file's name."""
    text: str
    since_ns: int
    """Whatever was heard after that belongs to it."""


class IncidentDetector:
    """From what the robot says to what is worth a file.

    Each second of an incident that goes on, or comes again and again, is in one file: the next begins where the last
    ended, and comes a whole memory later.
    """

    def __init__(self, config: RecorderConfig) -> None:
        self._config = config
        self._engaged: bool | None = None
        self._board: tuple[bool, str] | None = None
        self._armed_at = float("-inf")
        self._faults: dict[str, dict[str, tuple[float, tuple[Trouble, ...]]]] = {}
        """By service and process: when it has answered last, and its faults. The newest answer comes last."""
        self._events: dict[str, tuple[float, str]] = {}
        """The first of each kind that no file has yet: kind -> when, and what."""
        self._written_at = float("-inf")

    def on_estop(self, estop: EStop, now: float) -> None:
        """`now` here and below: monotonic, s."""
        if estop.engaged and self._engaged is False:
            self._report(now, "estop", f"emergency stop by {estop.by}: {estop.reason.what}")
        self._engaged = estop.engaged

    def on_base(self, base: BaseState, now: float) -> None:
        """What the base board says of itself."""
        latch = base.board.latch if base.board.latch not in {"", "none", "estop"} else ""
        board = base.board.connected, latch
        if self._board is not None and board != self._board:
            if self._board[0] and not base.board.connected:
                self._report(now, "board", f"the base board is lost: {base.reason}")
            elif latch and latch != self._board[1]:
                self._report(now, "board", f"the base board has latched: {latch.replace('_', ' ')}")
        self._board = board
        if base.armed:
            self._armed_at = now

    def on_health(self, health: Health, now: float) -> None:
        """Take what a process says of itself: a fault that its service did not have before is an event."""
        if health.service not in ANSWERING:
            return  # anybody may answer, and in any name
        told = self._faults.setdefault(health.service, {})
        since = now - _QUESTIONS * self._config.health_period
        known = {fault for at, faults in told.values() if at >= since for fault in faults}
        if told and not known.issuperset(health.faults):
            self._report(now, "fault", f"{health.service}: {'; '.join(map(str, health.faults))}")
        told.pop(health.instance, None)
        told[health.instance] = now, health.faults
        if len(told) > _PROCESSES:
            del told[next(iter(told))]

    def on_gone(self, service: str, now: float) -> None:
        """A service's process has left the network."""
        if service in WATCHED and now - self._armed_at <= _ARMED_LATELY:
            self._report(now, "gone", f"{service} ended while the robot was armed")

    def due(self, now: float) -> Incident | None:
        """What is to be written now, once; None: nothing."""
        kinds = [kind for kind in _GRAVEST_FIRST if kind in self._events]
        if not kinds:
            return None
        gravest, _ = self._events[kinds[0]]
        first = min(at for at, _ in self._events.values())
        config = self._config
        # Not before all that is in memory is new: what repeats itself costs no second file of the same minute.
        if now < max(gravest + config.after, self._written_at + config.before):
            return None
        since = max(first - config.before, self._written_at)
        text = "; ".join(self._events[kind][1] for kind in kinds)
        self._events, self._written_at = {}, now
        return Incident(kinds[0], text, round(since * 1e9))

    def _report(self, now: float, kind: str, text: str) -> None:
        self._events.setdefault(kind, (now, brief(text, _LONGEST_TEXT)))


class IncidentFile(NamedTuple):
    """A file of the flight recorder."""

    name: str
    """File name, which ends in `-<kind>.mcap`."""
    size: int
    """bytes."""
    at: float
    """s of the wall clock. Time of the last write."""


def surplus(files: Sequence[IncidentFile], config: RecorderConfig) -> list[str]:
    """Return the names of the files that must go. `files`: oldest first. The newest stays in any case.

    One file of each kind goes last: the first of the past week, which shows how a series of incidents began. The end of
    a series is among the newest files anyway. Where a kind has none of that week, its newest file counts.
    """
    gone = []
    left = list(files)
    kept: dict[str, IncidentFile] = {}
    for file in files:
        kind = file.name.rsplit("-", 1)[-1]
        if kind not in kept or kept[kind].at < files[-1].at - _SERIES:
            kept[kind] = file
    while len(left) > 1 and (len(left) > config.files or sum(file.size for file in left) > config.disk):
        goes = next((file for file in left[:-1] if file not in kept.values()), left[0])
        left.remove(goes)
        gone.append(goes.name)
    return gone


def _size(sample: RawSample) -> int:
    return len(sample.payload) + _OVERHEAD
