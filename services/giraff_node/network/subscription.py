"""Samples of one topic as Zenoh brings them: read, or told to be unreadable."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any, Final, Generic

import zenoh

from giraff_core.inbox import Inbox
from giraff_node.network.decode_errors import DecodeErrors
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.topics import SampleT, Topic
from giraff_schemas.trouble import Trouble

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
            self._bad_keys.bad(key, str(error), time.monotonic())
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

    def take(self) -> Iterator[SampleT]:
        self._fill()
        return super().take()

    def _fill(self) -> None:
        if self.subscriber is None:
            return
        for _ in range(_WAITING):  # what comes meanwhile waits: a flood must not hold the loop
            if (received := self.subscriber.try_recv()) is None:
                break
            if (sample := self._reader.read(received)) is not None:
                self.accept(sample)
