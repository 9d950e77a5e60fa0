"""What the flight recorder remembers, what makes it write, and which files then go. No I/O, no clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from giraff_mcap.raw_sample import RawSample
from giraff_recorder.config import RecorderConfig
from giraff_schemas.health import Health
from giraff_schemas.messages import BaseState, EStop
from giraff_schemas.services import WATCHED

_OVERHEAD: Final = 300
"""bytes that a sample in memory takes beside its payload."""
_ARMED_LATELY: Final = 2.0  # s


class Memory:
    """The newest samples, oldest first: of the last while, and never more than so many bytes."""

    def __init__(self, config: RecorderConfig) -> None:
        self._span_ns = round((config.before + config.after) * 1e9)
        self._most = config.memory
        self._samples: deque[RawSample] = deque()
        self._bytes = 0

    def add(self, samples: Iterable[RawSample]) -> None:
        """Remember these, and forget what is too old or too much."""
        for sample in samples:
            self._samples.append(sample)
            self._bytes += _size(sample)
        while self._samples and (
            self._bytes > self._most or self._samples[-1].at_ns - self._samples[0].at_ns > self._span_ns
        ):
            self._bytes -= _size(self._samples.popleft())

    def since(self, at_ns: int) -> list[RawSample]:
        """Those that came after `at_ns` (time.monotonic_ns)."""
        return [sample for sample in self._samples if sample.at_ns > at_ns]


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
        self._unwell: dict[str, str] = {}
        self._event: tuple[float, str, str] | None = None
        self._written_at = float("-inf")

    def on_estop(self, estop: EStop, now: float) -> None:
        """`now` here and below: monotonic, s."""
        if estop.engaged and self._engaged is False:
            self._tell(now, "estop", f"emergency stop by {estop.by}: {estop.reason}")
        self._engaged = estop.engaged

    def on_base(self, base: BaseState, now: float) -> None:
        """What the base board says of itself."""
        latch = base.board.latch if base.board.latch not in {"", "none", "estop"} else ""
        board = base.board.connected, latch
        if self._board is not None and board != self._board:
            if self._board[0] and not base.board.connected:
                self._tell(now, "board", f"the base board is lost: {base.reason}")
            elif latch and latch != self._board[1]:
                self._tell(now, "board", f"the base board has latched: {latch.replace('_', ' ')}")
        self._board = board
        if base.armed:
            self._armed_at = now

    def on_health(self, health: Health, now: float) -> None:
        """What a service says of itself: a fault that it has not had before is an event."""
        known, self._unwell[health.service] = self._unwell.get(health.service), "; ".join(health.faults)
        if not health.ok and known is not None and self._unwell[health.service] != known:
            self._tell(now, "fault", f"{health.service}: {self._unwell[health.service]}")

    def on_gone(self, service: str, now: float) -> None:
        """A service's process has left the network."""
        if service in WATCHED and now - self._armed_at <= _ARMED_LATELY:
            self._tell(now, "gone", f"{service} ended while the robot was armed")

    def due(self, now: float) -> Incident | None:
        """What is to be written now, once; None: nothing."""
        if self._event is None:
            return None
        at, kind, text = self._event
        config = self._config
        # Not before all that is in memory is new: what repeats itself costs no second file of the same minute.
        if now < max(at + config.after, self._written_at + config.before):
            return None
        since = max(at - config.before, self._written_at)
        self._event, self._written_at = None, now
        return Incident(kind, text, round(since * 1e9))

    def _tell(self, now: float, kind: str, text: str) -> None:
        if self._event is None:
            self._event = now, kind, text


def surplus(files: Sequence[tuple[str, int]], config: RecorderConfig) -> list[str]:
    """Of these files (name, bytes), the oldest first: those that must go. The newest stays in any case."""
    gone = []
    left = list(files)
    while len(left) > 1 and (len(left) > config.files or sum(size for _, size in left) > config.disk):
        gone.append(left.pop(0)[0])
    return gone


def _size(sample: RawSample) -> int:
    return len(sample.payload) + _OVERHEAD
