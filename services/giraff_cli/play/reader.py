"""A recording's samples, ready before their time."""

import sys
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any, Final, NamedTuple

import msgspec

from giraff_mcap.reading import Recorded, Recording, RecordingError, params_in
from giraff_mcap.unread import Unread
from giraff_schemas.codec import DecodeError
from giraff_schemas.topics import topic_of

_AHEAD: Final = 4000  # samples that are read before their time: ten seconds of a whole robot
_READ_AGAIN: Final = 0.02  # s
_SWITCH: Final = 1e-4  # s for which the reading thread may keep the interpreter; by default 5 ms
_BETWEEN_ROUNDS_NS: Final = 20_000_000
_LONGEST_GAP_NS: Final = 2_000_000_000
"""ns. Longest time between two samples with `--skip-gaps`."""


class RecordedSample(NamedTuple):
    """A sample that waits for its time."""

    at_ns: int
    """Since the first, in the recording's own time."""
    key: str
    payload: bytes
    encoding: str


class Reader:
    """Reads ahead in a thread of its own: a chunk takes longer to unpack than a sample may come late."""

    def __init__(self, recording: Recording, topics: Sequence[str], *, loop: bool, skip_gaps: bool) -> None:
        self._recording = recording
        self._topics = topics
        self._loop = loop
        self._skip_gaps = skip_gaps
        self._read: deque[RecordedSample] = deque()
        self._ended = False
        self._error: Exception | None = None
        self.trouble = ""
        """Why the rest cannot be read."""
        self.unread = Unread()
        """What the first round could not read."""
        self._thread = threading.Thread(target=self._run, name="reading", daemon=True)

    def start(self) -> None:
        sys.setswitchinterval(_SWITCH)
        self._thread.start()

    def next(self) -> RecordedSample | None:
        """Return the next sample; None: that was all. Raises the fault of this program that ended the reading."""
        while not self._read:
            if self._ended and not self._read:
                if self._error is not None:
                    raise self._error
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
        except Exception as error:  # noqa: BLE001  whoever takes the samples raises it
            self._error = error
        finally:
            self._ended = True

    def _rounds(self) -> Iterator[RecordedSample]:
        begins_ns, number = 0, 1
        while True:
            before_ns: int | None = None
            ends_ns = begins_ns
            for sample in self._recording.samples(self._topics, self.unread if number == 1 else None):
                passed_ns = 0 if before_ns is None else sample.heard_ns - before_ns
                before_ns = sample.heard_ns
                ends_ns += min(passed_ns, _LONGEST_GAP_NS) if self._skip_gaps else passed_ns
                yield RecordedSample(ends_ns, sample.key, _payload(sample, number), sample.encoding)
            if not self._loop or before_ns is None:
                return
            begins_ns, number = ends_ns + _BETWEEN_ROUNDS_NS, number + 1


def _payload(sample: Recorded, number: int) -> bytes:
    """Return a payload as it was. In later rounds, samples of Giraff get another instance: their numbers begin anew."""
    if number == 1 or (topic_of(sample.key) is None and params_in(sample) is None):
        return sample.payload
    with suppress(DecodeError):  # torn
        content: Any = sample.content()
        if isinstance(content, dict) and isinstance(content.get("instance"), str):
            return msgspec.msgpack.encode(content | {"instance": f"{content['instance']}-{number}"})
    return sample.payload
