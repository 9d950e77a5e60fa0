"""What has come for a service and waits for its loop."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Final, Generic, TypeVar

MOST_REQUESTS: Final = 20
"""That wait for their answers; the oldest goes without."""

ItemT = TypeVar("ItemT")


class Inbox(Generic[ItemT]):
    """All that has come since the last `pop_all`, oldest first; a reader that falls behind loses the oldest."""

    def __init__(self, limit: int) -> None:
        self._samples: deque[ItemT] = deque(maxlen=limit)

    def accept(self, sample: ItemT) -> None:
        self._samples.append(sample)

    def __len__(self) -> int:
        """Return how many wait."""
        return len(self._samples)

    def pop_all(self) -> Iterator[ItemT]:
        for _ in range(len(self._samples)):  # what comes meanwhile waits: a flood must not hold the loop
            yield self._samples.popleft()
