"""Which pages are sent the picture of the robot's camera, and when the next one. No I/O and no clock.

A person switches it on at a page that may drive. Whatever ends it, it never comes back by itself.
"""

import math
import struct
from dataclasses import dataclass
from typing import Final

from giraff_core.picture.receiver import OpenSource, PictureReceiver
from giraff_schemas.camera import CameraState, PictureSize
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.messages import CameraView, Looking
from giraff_web.pages import Pages

SILENT: Final = 1.5
"""s without the confirmation of a picture after which a page has lost it, and without a state after which the camera
is not heard."""
SLOW: Final = 0.15
"""s from which a picture's confirmation tells of a slow link to a page: then all pages are sent the small one."""
QUICK: Final = 0.08
"""s within which a small picture is confirmed where the full one may be tried."""
_PROVEN: Final = 10
"""Small pictures in a row that were confirmed so quickly."""
_REST: Final = 10.0
"""s after a slow one until they count."""
_APART: Final = 1.0
"""s between two starts to look, however often a page is tapped."""
_HEADER: Final = struct.Struct(">IIQ")
"""Number of the picture, then epoch and robot_ns of its tick, both 0 where it has none. The JPEG follows."""

_AGAIN: Final = "tap to see it again"
_NO_CAMERA: Final = Trouble("no camera of the robot is heard", "check that giraff_camera runs")
_RESTARTED: Final = Trouble("the camera was started anew", _AGAIN)
_NOT_SHOWN: Final = Trouble(f"the page showed nothing for {SILENT:g} s", f"check the wireless network, and {_AGAIN}")


@dataclass
class _Page:
    """One page that looks."""

    device: str
    shown: int = 0
    """Number of the newest picture that it was sent."""
    is_waiting: bool = False
    """It has not confirmed that one yet."""
    at: float = 0.0
    """When it was sent."""


class PageCameras:
    """Times are seconds of any one monotonic clock."""

    def __init__(self, pages: Pages, by: str, open_source: OpenSource | None) -> None:
        """`by`: this service, as people know it. `open_source`: None: no page may look."""
        self._tell, self._by = pages, by
        self._may_look = open_source is not None
        self._pictures = PictureReceiver(open_source, apart=_APART)
        self._looking: dict[int, _Page] = {}
        self._state: CameraState | None = None
        self._heard = -math.inf
        self._n = 0
        self._newest = b""
        self._largest: PictureSize = "small"
        self._quick = 0
        self._counts_from = -math.inf

    @property
    def devices(self) -> str:
        """Whose pages look; empty: none does."""
        return ", ".join(dict.fromkeys(page.device for page in self._looking.values()))

    def view(self, now: float) -> CameraView | None:
        """What every page is told of the camera; None: none was ever heard."""
        if self._state is None:
            return None
        if now - self._heard > SILENT:
            return CameraView(askers=(), why=_NO_CAMERA)
        why = self._pictures.trouble(self._state.camera) or self._state.reason
        return CameraView(askers=tuple(asker.by for asker in self._state.askers), why=why)

    def on_state(self, state: CameraState, now: float) -> None:
        """Take what a camera says of itself. Of several, the one that was heard first counts."""
        before = self._state
        if before is not None and state.camera != before.camera and now - self._heard <= SILENT:
            return
        self._state, self._heard = state, now
        if before is not None and state.instance != before.instance:
            for page in [*self._looking]:
                self._end(page, _RESTARTED)

    def switch(self, page: int, device: str, *, on: bool) -> None:
        """A person has switched it on or off at a page that may drive."""
        if not on:
            self._end(page, NO_TROUBLE)
        elif self._state is None or not self._may_look:
            self._end(page, _NO_CAMERA)
        else:
            if not self._looking:
                self._counts_from = -math.inf
            self._looking.setdefault(page, _Page(device))
            self._largest, self._quick = "small", 0  # nothing is known of the link to this page
            self._tell.send(page, Looking(on=True, why=NO_TROUBLE))

    def on_closed(self, page: int) -> None:
        """Forget a page that is gone."""
        if self._looking.pop(page, None) is not None:
            self._close_unseen()

    def on_seen(self, page: int, n: int, now: float) -> None:
        """Take a page's word that it has shown a picture."""
        looks = self._looking.get(page)
        if looks is None or not looks.is_waiting or n != looks.shown:
            return
        looks.is_waiting = False
        took = now - looks.at
        if took > SLOW:
            self._slow_down(now)
        elif took > QUICK or now < self._counts_from:
            self._quick = 0
        else:
            self._quick += 1
        if self._quick >= _PROVEN:
            self._largest = "full"

    def poll(self, now: float) -> None:
        """Send what is to be sent now."""
        for number, page in list(self._looking.items()):
            if page.is_waiting and now - page.at > SILENT:
                self._end(number, _NOT_SHOWN)
            elif page.is_waiting and now - page.at > SLOW:
                self._slow_down(now)
        if not self._looking or self._state is None:
            return
        self._pictures.by = f"{self._by} ({self.devices})"
        if (picture := self._pictures.ask(self._state.camera, now, self._largest)) is not None:
            self._n += 1
            tick = picture.tick
            header = _HEADER.pack(self._n, *((tick.epoch, tick.robot_ns) if tick is not None else (0, 0)))
            self._newest = header + picture.jpeg
        for number, page in self._looking.items():
            if self._newest and not page.is_waiting and page.shown < self._n:
                page.shown, page.is_waiting, page.at = self._n, True, now
                self._tell.send_picture(number, self._newest)

    def close(self) -> None:
        """No page looks any more."""
        self._looking.clear()
        self._close_unseen()

    def _slow_down(self, now: float) -> None:
        self._largest, self._quick, self._counts_from = "small", 0, now + _REST

    def _end(self, page: int, why: Trouble) -> None:
        self._looking.pop(page, None)
        self._tell.send(page, Looking(on=False, why=why))
        self._close_unseen()

    def _close_unseen(self) -> None:
        if not self._looking:
            self._pictures.close()
            self._newest = b""
