"""Samples of one topic as Zenoh brings them: read, or told to be unreadable."""

import time
from collections.abc import Callable, Iterator
from typing import Any, Final, Generic

import msgspec
import zenoh

from giraff_core.io import Inbox
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.topics import SampleT, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble

MOST: Final = 20
"""Keys of one subscription that are named; whoever invents more of them fills neither memory nor log."""
MENDED_AFTER: Final = 2.0
"""s without a bad payload until a good one shows that a key is sound again."""
_LONGEST: Final = 300  # characters of a fault: its text may quote the payload


class DecodeErrors:
    """Reports payloads of one subscription that cannot be read. Times are seconds of any one monotonic clock."""

    def __init__(self, pattern: str, tell: Callable[[str, Trouble], None]) -> None:
        self._pattern = pattern
        self._tell = tell
        self._last: dict[str, float] = {}

    def bad(self, key: str, why: Trouble, now: float) -> None:
        """A payload on `key` could not be read."""
        if key in self._last:
            self._last[key] = now
        elif len(self._last) < MOST:
            self._last[key] = now
            self._tell(f"decode {key}", msgspec.structs.replace(why, what=why.what[:_LONGEST]))
        else:
            self._tell(
                f"decode more of {self._pattern}",
                Trouble(
                    f"{self._pattern}: unreadable payloads on more than {MOST} keys", "find out who publishes there"
                ),
            )

    def good(self, key: str, now: float) -> None:
        """A payload on `key` was read."""
        if key in self._last and now - self._last[key] > MENDED_AFTER:
            del self._last[key]
            self._tell(f"decode {key}", NO_TROUBLE)
            self._tell(f"decode more of {self._pattern}", NO_TROUBLE)


_WAITING: Final = 300
"""Payloads that wait for a turn. Rubbish must not push out what can be read, and is seen only when it is read."""


class Reader(Generic[SampleT]):
    """Reads the samples of one subscription."""

    def __init__(self, topic: Topic[SampleT], pattern: str, tell: Callable[[str, Trouble], None]) -> None:
        """`pattern`: the key with the robot's name; `tell`: as `IO.set_notice`."""
        self._topic = topic
        self._bad_keys = DecodeErrors(pattern, tell)

    def read(self, received: zenoh.Sample) -> SampleT | None:
        """Return the sample. Return None where the payload cannot be read, and tell of it."""
        key = str(received.key_expr)
        try:
            sample = decode(self._topic, key, bytes(received.payload), str(received.encoding))
        except DecodeError as error:
            self._bad_keys.bad(key, error.trouble, time.monotonic())
            return None
        self._bad_keys.good(key, time.monotonic())
        return sample


class PolledInbox(Inbox[SampleT]):
    """Samples that make no turn due. They wait undecoded in a ring of Zenoh until a turn takes them.

    No thread of Python wakes for them.
    """

    def __init__(self, limit: int, reader: Reader[SampleT]) -> None:
        super().__init__(limit)
        self.ring: zenoh.handlers.RingChannel[zenoh.Sample] = zenoh.handlers.RingChannel(max(limit, _WAITING))
        """The handler for the subscriber."""
        self.subscriber: zenoh.Subscriber[Any] | None = None
        self._reader = reader

    def __len__(self) -> int:
        self._fill()
        return super().__len__()

    def pop_all(self) -> Iterator[SampleT]:
        self._fill()
        return super().pop_all()

    def _fill(self) -> None:
        if self.subscriber is None:
            return
        for _ in range(_WAITING):  # what comes meanwhile waits: a flood must not hold the loop
            if (received := self.subscriber.try_recv()) is None:
                break
            if (sample := self._reader.read(received)) is not None:
                self.accept(sample)
