"""A request that is repeated until it is answered, without ever blocking. No I/O here."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from typing import Final, Generic

from giraff_schemas.topics import AnswerT

_PERIOD: Final = 0.2  # s between two attempts
_MOST_ANSWERS: Final = 64  # that wait at once; anybody may answer


class RetriedRequest(ABC, Generic[AnswerT]):
    """Call `poll` each turn until it is answered.

    An answer of which `settles` is false is kept as `refusal`, and asking goes on. One that does not count is judged
    again at each turn, because what it lacks may still come; meanwhile the reason is the `fault`.
    """

    def __init__(self, settles: Callable[[AnswerT], bool | str]) -> None:
        """`settles` judges an answer: whether it settles the matter, or, as a text, why it does not count."""
        self._settles = settles
        self._answers: deque[AnswerT] = deque(maxlen=_MOST_ANSWERS)
        self._next = -1.0
        self.attempts = 0
        self.fault = ""
        """What the newest attempt ran into; empty: nothing, or no answer yet."""
        self.refusal: AnswerT | None = None
        """The newest answer that does not settle it."""

    def poll(self, now: float) -> AnswerT | None:
        """The answer, once there is one; else None, and another attempt when it is time. `now`: monotonic, s."""
        for _ in range(len(self._answers)):
            answer = self._answers.popleft()
            judgement = self._settles(answer)
            if judgement is True:
                self._answers.appendleft(answer)
                return answer
            if isinstance(judgement, str):
                self.fault = judgement
                self._answers.append(answer)
            else:
                self.refusal = answer
        if now >= self._next:
            self._next = now + _PERIOD
            self.attempts += 1
            self._attempt()
        return None

    def on_answer(self, answer: AnswerT) -> None:
        """One has come, from any thread."""
        self._answers.append(answer)

    @abstractmethod
    def _attempt(self) -> None:
        """Send the request once."""
