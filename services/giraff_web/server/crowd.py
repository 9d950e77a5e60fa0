"""How a crowd of one kind is kept small: who may enter, and who goes for that. No I/O and no clock."""

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Generic, Protocol, TypeVar

from giraff_web.limits import Allowance


class Guest(Protocol):
    """A member of a crowd."""

    @property
    def address(self) -> str: ...
    @property
    def since(self) -> float:
        """When it did something last, s."""
        ...

    @property
    def is_busy(self) -> bool:
        """Whether the crowd must keep it."""
        ...

    def end(self) -> None: ...


GuestT = TypeVar("GuestT", bound=Guest)


class Crowd(Generic[GuestT]):
    """The guests of one kind. One that is not busy goes for a newcomer: the oldest of the address with the most."""

    def __init__(self, allowance: Allowance) -> None:
        self.allowance = allowance
        self._guests: dict[GuestT, None] = {}

    def __len__(self) -> int:
        return len(self._guests)

    def __iter__(self) -> Iterator[GuestT]:
        return iter(self._guests)

    def enter(self, guest: GuestT) -> bool:
        """Let it in. Another one ends for it where need be; False: there is no room."""
        own = [each for each in self._guests if each.address == guest.address]
        if len(own) >= self.allowance.of_one_address:
            has_room = self._send_away(own)
        else:
            has_room = len(self._guests) < self.allowance.most or self._send_away(self._guests)
        if has_room:
            self._guests[guest] = None
        return has_room

    def leave(self, guest: GuestT) -> None:
        """Forget it, if it is here."""
        self._guests.pop(guest, None)

    def end_late(self, now: float) -> None:
        """End those that have done nothing for too long."""
        late = now - self.allowance.patience
        self._end(each for each in self._guests if each.since <= late and not each.is_busy)

    def end_all(self) -> None:
        """End busy ones, too."""
        self._end(self._guests)

    def _send_away(self, among: Iterable[GuestT]) -> bool:
        idle = [each for each in among if not each.is_busy]
        if not idle:
            return False
        counts = Counter(each.address for each in idle)
        self._end([min(idle, key=lambda each: (-counts[each.address], each.since))])
        return True

    def _end(self, guests: Iterable[GuestT]) -> None:
        for guest in list(guests):
            self.leave(guest)
            guest.end()
