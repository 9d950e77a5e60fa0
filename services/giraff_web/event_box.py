"""What pages have said and the service's turn has not taken yet: bounded, whatever a page does."""

from collections import deque
from collections.abc import Iterable
from itertools import count
from typing import Final

from giraff_web.messages import PageWish, RouteHold
from giraff_web.pages import Closed, Event, Opened, Said, StopAsked

WISHES_KEPT: Final = 32
"""Wishes and holds of a route, of one page; the oldest goes."""
_OTHERS_KEPT: Final = 8
"""Other messages of one page: so no flood of wishes loses the end of a hold."""
_STOPS_KEPT: Final = 64
"""A further one asks for what is asked for already."""


class _OfPage:
    """Numbers of one page's events, oldest first."""

    def __init__(self) -> None:
        self.opened: list[int] = []
        self.wishes: deque[int] = deque()
        self.others: deque[int] = deque()


class EventBox:
    """In the order in which they came. Of one thread at a time."""

    def __init__(self) -> None:
        self._numbers = count()
        self._events: dict[int, Event] = {}
        self._pages: dict[int, _OfPage] = {}
        self._stops = 0

    def __len__(self) -> int:
        return len(self._events)

    def put(self, event: Event) -> None:
        match event:
            case StopAsked():
                if self._stops < _STOPS_KEPT:
                    self._stops += 1
                    self._add(event)
            case Opened():
                self._of(event.page).opened.append(self._add(event))
            case Said():
                self._say(event)
            case Closed():
                self._close(event)

    def pop_all(self) -> Iterable[Event]:
        """All of them."""
        taken = list(self._events.values())
        self._events.clear()
        self._pages.clear()
        self._stops = 0
        return taken

    def _say(self, event: Said) -> None:
        of_page = self._of(event.page)
        kept, most = (
            (of_page.wishes, WISHES_KEPT)
            if isinstance(event.message, PageWish | RouteHold)
            else (of_page.others, _OTHERS_KEPT)
        )
        kept.append(self._add(event))
        if len(kept) > most:
            del self._events[kept.popleft()]

    def _close(self, event: Closed) -> None:
        """What a page said last counts no more once it is gone, and one that came meanwhile was never there."""
        of_page = self._pages.pop(event.page, _OfPage())
        for number in (*of_page.opened, *of_page.wishes, *of_page.others):
            del self._events[number]
        if not of_page.opened:
            self._add(event)

    def _of(self, page: int) -> _OfPage:
        return self._pages.setdefault(page, _OfPage())

    def _add(self, event: Event) -> int:
        number = next(self._numbers)
        self._events[number] = event
        return number
