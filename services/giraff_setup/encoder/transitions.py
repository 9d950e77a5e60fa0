"""Changes of an encoder's two channels, as the board timed them: asked for, collected, and in whole runs. Pure."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

from giraff_schemas.wire import STAMPS_PER_MS, Frame, WheelsFrame
from giraff_schemas.wires.transitions import (
    TRANSITION_A,
    TRANSITION_B,
    TRANSITION_STAMPS,
    TRANSITIONS_HOLD_MS,
    TRANSITIONS_PERIOD_MS,
    TransitionsFrame,
    TransitionsRequestFrame,
)

CHANNELS: Final = ("A", "B")
A: Final = 0
B: Final = 1

Levels = tuple[bool, bool]
"""Levels of A and B; True is high."""
_ASK_EVERY_US: Final = TRANSITIONS_HOLD_MS * 1000 // 5
_MUTE_US: Final = 20 * TRANSITIONS_PERIOD_MS * 1000  # a board that is asked answers in each period


class Transition(NamedTuple):
    """One change of a channel."""

    after_ms: float | None
    """ms since the one before. None: unknown."""
    levels: Levels
    """Levels of A and B after it."""

    @classmethod
    def read(cls, word: int, *, is_torn: bool = False) -> "Transition":
        """Read one as the board writes it. `is_torn`: what came before it was lost."""
        stamps = word & TRANSITION_STAMPS
        after_ms = None if is_torn or stamps == TRANSITION_STAMPS else stamps / STAMPS_PER_MS
        return cls(after_ms, (bool(word & TRANSITION_A), bool(word & TRANSITION_B)))


class Edge(NamedTuple):
    """One change of one channel, in its run."""

    at: float
    """ms since the run's begin."""
    channel: int
    """A or B."""
    level: bool
    """Level after it."""


class Run(NamedTuple):
    """Edges of which none was lost."""

    levels: Levels
    """Levels of A and B before the first edge."""
    edges: Sequence[Edge]


def runs_of(transitions: Iterable[Transition]) -> Iterator[Run]:
    """Split transitions where the board or the line has lost some."""
    levels: Levels | None = None
    begin, edges, at = (False, False), list[Edge](), 0.0
    for transition in transitions:
        if levels is None or transition.after_ms is None:
            if edges:
                yield Run(begin, edges)
            begin, edges, at = transition.levels, [], 0.0
        else:
            at += transition.after_ms
            edges += _edges(at, levels, transition.levels, edges[-1].channel if edges else B)
        levels = transition.levels
    if edges:
        yield Run(begin, edges)


def _edges(at: float, before: Levels, after: Levels, last: int) -> Iterator[Edge]:
    """Two edges where the board saw both channels change at once, first of the channel whose turn it is."""
    for channel in (1 - last, last):
        if before[channel] != after[channel]:
            yield Edge(at, channel, after[channel])


def levels_between(run: Run, channel: int, begin: float, end: float) -> list[tuple[float, bool]]:
    """Return when a channel took which level within a time, with the one that it had at its begin."""
    level, steps = run.levels[channel], list[tuple[float, bool]]()
    for edge in run.edges:
        if edge.channel != channel:
            continue
        if edge.at <= begin:
            level = edge.level
        elif edge.at < end:
            steps.append((edge.at, edge.level))
    return [(begin, level), *steps]


class MuteBoardError(Exception):
    """The board does not tell transitions."""


class Listener:
    """Asks for one encoder's transitions while its wheel turns: the `watch` of `WheelBench.drive`."""

    def __init__(self, encoder: int) -> None:
        """`encoder`: its number on the board."""
        self.encoder = encoder
        self.transitions: list[Transition] = []
        self._seq: int | None = None
        self._is_torn = True
        self._first: WheelsFrame | None = None
        self._asked_us = 0
        self._is_heard = False

    def __call__(self, frame: Frame) -> Frame | None:
        """Return the request that is due. MuteBoardError when none is answered."""
        if self._seq is not None and (frame.seq - self._seq) & 0xFFFF != 1:
            self._is_torn = True  # the line has lost a frame, maybe one of transitions
        self._seq = frame.seq
        if isinstance(frame, TransitionsFrame) and frame.encoder == self.encoder:
            self._is_heard = True
            for word in frame.transitions[: frame.count]:
                self.transitions.append(Transition.read(word, is_torn=self._is_torn))
                self._is_torn = False
        if not isinstance(frame, WheelsFrame):
            return None
        first = self._first = self._first or frame
        since_us = (frame.board_us - first.board_us) & 0xFFFFFFFF
        if not self._is_heard and since_us > _MUTE_US:
            raise MuteBoardError
        if first is not frame and (frame.board_us - self._asked_us) & 0xFFFFFFFF < _ASK_EVERY_US:
            return None
        self._asked_us = frame.board_us
        return TransitionsRequestFrame(seq=0, encoder=self.encoder)
