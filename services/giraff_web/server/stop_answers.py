"""Requests for a stop that wait for base's word of it."""

import asyncio

from giraff_schemas.messages import EStop
from giraff_web.limits import Allowance
from giraff_web.server.crowd import Crowd


class _Waiter:
    is_busy = False

    def __init__(self, address: str, turns: int) -> None:
        self.address = address
        self.turns = turns
        """Turns of the service until it asked: the next one has its stop at the latest."""
        self.answer: asyncio.Future[EStop | None] = asyncio.get_running_loop().create_future()
        self.since = self.answer.get_loop().time()

    def end(self) -> None:
        """Answer it without base's word."""
        self.give(None)

    def give(self, word: EStop | None) -> None:
        if not self.answer.done():
            self.answer.set_result(word)


class StopAnswers:
    """Of the event loop's thread, except `turns` and `is_waited`."""

    def __init__(self, allowance: Allowance) -> None:
        self._waiting: Crowd[_Waiter] = Crowd(allowance)
        self.turns = 0
        """Counts how often the service has taken all stops that were asked for. Written in its thread."""

    @property
    def is_waited(self) -> bool:
        """Whether anybody waits. From any thread."""
        return len(self._waiting) > 0

    async def wait(self, address: str) -> EStop | None:
        """Wait for base's word of the stop that was put just before; None: it did not come in time."""
        waiter = _Waiter(address, self.turns)
        if not self._waiting.enter(waiter):
            return None
        try:
            async with asyncio.timeout(self._waiting.allowance.patience):
                return await waiter.answer
        except TimeoutError:
            return None
        finally:
            self._waiting.leave(waiter)

    def give(self, word: EStop, turns: int) -> None:
        """Answer those whose stop an earlier turn has taken: for the others base's word may be older than the stop."""
        for waiter in self._waiting:
            if waiter.turns + 1 < turns:
                waiter.give(word)
