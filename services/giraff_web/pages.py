"""The pages that are open, as the service's turn reaches them: `giraff_web.server` in a process, a list in a test."""

from collections.abc import Iterable
from typing import NamedTuple, Protocol

from giraff_core.io import Selectable
from giraff_schemas.messages import EStop
from giraff_web.messages import (
    Go,
    Hello,
    LetGo,
    Look,
    Looking,
    PageWish,
    PictureSeen,
    Plan,
    Refused,
    Reset,
    Route,
    RouteCancel,
    RouteHold,
    State,
)

ForOnePage = Hello | Plan | Route | Refused | Looking
"""Messages that the service sends to one page."""


class Opened(NamedTuple):
    """A page has connected."""

    page: int
    """From 1, never again the same one."""
    device: str
    """As people know it: `Android phone at 192.168.1.7`."""
    may_drive: bool


class Closed(NamedTuple):
    """A page's connection has ended, however it did."""

    page: int


class Said(NamedTuple):
    """A page that may drive has said something, or any page that a route is to end."""

    page: int
    message: PageWish | LetGo | Reset | Look | PictureSeen | Go | RouteHold | RouteCancel


class StopAsked(NamedTuple):
    """Somebody asks for the emergency stop: by a page, or by a request without one."""

    device: str
    off: bool = False


Event = Opened | Closed | Said | StopAsked


class Pages(Selectable, Protocol):
    """Its descriptor is readable when there are events."""

    def poll(self) -> Iterable[Event]:
        """What has happened since the last call, in its order. A flood of one page's loses that page's oldest wishes,
        and never a stop."""
        ...

    def show(self, state: State) -> None:
        """Replace what every page is shown: each gets the newest as soon as it can take it."""
        ...

    def confirm(self, word: EStop) -> None:
        """Answer those whose stop an earlier turn has taken: base says in this turn that it stands."""
        ...

    def send(self, page: int, message: ForOnePage) -> None:
        """Tell one page; nothing when it is gone."""
        ...

    def send_picture(self, page: int, data: bytes) -> None:
        """Send one page a picture of the camera, after all else that waits; nothing when it is gone."""
        ...
