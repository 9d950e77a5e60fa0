"""One encoder's transitions, asked for and collected while its wheel turns. Pure: time is the board's."""

from __future__ import annotations

from typing import Final

from giraff_schemas.wire import Frame, WheelsFrame
from giraff_schemas.wires.transitions import (
    TRANSITIONS_HOLD_MS,
    TRANSITIONS_PERIOD_MS,
    TransitionsFrame,
    TransitionsRequestFrame,
)
from giraff_setup.encoder.transitions import Transition

_ASK_EVERY_US: Final = TRANSITIONS_HOLD_MS * 1000 // 5
_MUTE_US: Final = 20 * TRANSITIONS_PERIOD_MS * 1000  # a board that is asked answers in each period


class MuteBoardError(Exception):
    """The board does not tell transitions."""


class Listener:
    """Given to `WheelBench.drive` as its `watch`."""

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
