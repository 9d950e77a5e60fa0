"""A recording's samples, ready before their time."""

from __future__ import annotations

import sys
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import msgspec

from giraff_mcap.reading import Recorded, Recording, RecordingError

_AHEAD: Final = 4000  # samples that are read before their time: ten seconds of a whole robot
_READ_AGAIN: Final = 0.02  # s
_SWITCH: Final = 1e-4  # s for which the reading thread may keep the interpreter; by default 5 ms
_BETWEEN_ROUNDS_NS: Final = 20_000_000


class RecordedSample(NamedTuple):
    """A sample that waits for its time."""

    at_ns: int
    """Since the first, in the recording's own time."""
    key: str
    payload: bytes
    encoding: str


class Reader:
    """Reads ahead in a thread of its own: a chunk takes longer to unpack than a sample may come late."""

    def __init__(self, recording: Recording, topics: Sequence[str], *, loop: bool) -> None:
        self._recording = recording
        self._topics = topics
        self._loop = loop
        self._read: deque[RecordedSample] = deque()
        self._ended = False
        self.trouble = ""
        """Why the rest cannot be read."""
        self._thread = threading.Thread(target=self._run, name="reading", daemon=True)

    def start(self) -> None:
        sys.setswitchinterval(_SWITCH)
        self._thread.start()

    def next(self) -> RecordedSample | None:
        """The next sample; None: that was all."""
        while not self._read:
            if self._ended and not self._read:
                return None
            time.sleep(_READ_AGAIN / 10.0)
        return self._read.popleft()

    def _run(self) -> None:
        try:
            for said in self._rounds():
                self._read.append(said)
                while len(self._read) >= _AHEAD:
                    time.sleep(_READ_AGAIN)
        except RecordingError as error:
            self.trouble = str(error)
        finally:
            self._ended = True

    def _rounds(self) -> Iterator[RecordedSample]:
        begins_ns, number = 0, 1
        while True:
            first_ns: int | None = None
            ends_ns = begins_ns
            for sample in self._recording.samples(self._topics):
                first_ns = sample.heard_ns if first_ns is None else first_ns
                ends_ns = begins_ns + sample.heard_ns - first_ns
                yield RecordedSample(ends_ns, sample.key, _payload(sample, number), sample.encoding)
            if not self._loop or first_ns is None:
                return
            begins_ns, number = ends_ns + _BETWEEN_ROUNDS_NS, number + 1


def _payload(sample: Recorded, number: int) -> bytes:
    """As it was; in a later round by a maker of its own, whose numbers begin anew."""
    if number == 1:
        return sample.payload()
    content: Any = sample.content()
    if isinstance(content, dict) and isinstance(content.get("instance"), str):
        content["instance"] += f"-{number}"
    return msgspec.msgpack.encode(content)
