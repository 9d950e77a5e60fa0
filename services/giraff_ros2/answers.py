"""Whether a process of ROS is awake, by its answers to questions in Zenoh's admin space. No I/O and no clock."""

import math
from collections import deque
from typing import Final

PROMPT: Final = 0.3
"""s within which a process that is awake answers. Most take some ms."""


class Answers:
    """Feed it each question to one process and each answer. Times are monotonic, s.

    A process that was frozen, or cut off, answers late what it was asked meanwhile. So a lapse shows as a late answer,
    or as none. A time in which nobody asked proves nothing, and counts as a lapse, too.
    """

    def __init__(self) -> None:
        self.newest = -math.inf
        """When the newest question was asked that the process has answered; -inf: it has answered none."""
        self._asked = -math.inf
        self._open: deque[float] = deque()
        """When each question was asked that waits for its answer, the oldest first."""
        self._prompt_since = math.inf

    def on_question(self, now: float) -> None:
        """Take that the process is asked."""
        if math.isinf(self.prompt_since(now)):
            self._open.clear()
            self._prompt_since = now
        self._asked = now
        self._open.append(now)

    def on_answer(self, asked: float, now: float) -> None:
        """Take the answer to the question that was asked at `asked`."""
        self.newest = max(self.newest, asked)
        if asked in self._open:
            self._open.remove(asked)
        if now - asked > PROMPT:
            self._prompt_since = max(self._prompt_since, now)

    def prompt_since(self, now: float) -> float:
        """Return since when each question was answered within `PROMPT`; inf: the newest ones were not."""
        oldest = self._open[0] if self._open else self._asked
        return math.inf if now - oldest > PROMPT else self._prompt_since
