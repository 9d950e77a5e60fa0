"""What has come for a service and waits for its loop."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Generic, TypeVar

import zenoh

from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.topics import AnswerT, RequestT

ItemT = TypeVar("ItemT")


class Inbox(Generic[ItemT]):
    """All that has come since the last `take`, oldest first; a reader that falls behind loses the oldest."""

    def __init__(self, limit: int) -> None:
        self._samples: deque[ItemT] = deque(maxlen=limit)

    def accept(self, sample: ItemT) -> None:
        self._samples.append(sample)

    def take(self) -> Iterator[ItemT]:
        for _ in range(len(self._samples)):  # what comes meanwhile waits: a flood must not hold the loop
            yield self._samples.popleft()


class Asked(Generic[RequestT, AnswerT]):
    """One request of somebody, waiting for its answer."""

    def __init__(self, query: zenoh.Query, request: RequestT) -> None:
        self._query = query
        self.request = request

    def answer(self, answer: AnswerT) -> None:
        with self._query as query:
            query.reply(query.key_expr, encode(answer), encoding=encoding_of(type(answer)))
