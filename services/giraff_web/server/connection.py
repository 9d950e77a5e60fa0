"""One page's WebSocket: what it is told and when, and what it may say."""

import asyncio
import contextlib
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Final, NamedTuple

import msgspec
from aiohttp import WSMsgType, web

from giraff_schemas.text import plain
from giraff_web.limits import Limits, Rate, SendWindow
from giraff_web.messages import (
    LARGEST,
    End,
    FromPage,
    Hello,
    Looking,
    OpenPage,
    OpenPages,
    Plan,
    Route,
    RouteCancel,
    StateSeen,
    Stop,
)
from giraff_web.pages import Event, ForOnePage, Said, StopAsked

BAD_MESSAGE: Final = 4400
NOT_ALLOWED: Final = 4403
SILENT: Final = 4408
ENDED: Final = 4410
"""Somebody has ended this page: `page/link.js` does not connect again by itself."""
TOO_MANY: Final = 4429
LEAVING: Final = 1001

_MOST_TOLD: Final = 16
"""Messages that wait beside the state; the oldest goes."""
_LONGEST_REASON: Final = 120
"""Bytes; a close frame has room for 123."""
_GOODBYE: Final = 1.0  # s that the page has to close its side
_READ_AT_MOST: Final = 4 * LARGEST
"""Bytes; what is larger is not read to its end."""
_MADE_BY_LIBRARY: Final = {
    1002: "this is no WebSocket frame",
    1007: "a message is text of UTF-8",
    1009: f"a message has at most {LARGEST} bytes",
}

_decoder: Final = msgspec.json.Decoder(FromPage)


class Shown(NamedTuple):
    """A state, encoded once for all pages."""

    n: int
    data: bytes


class Socket(web.WebSocketResponse):
    """Closes with the codes of this service, also where the library finds the fault."""

    def __init__(self) -> None:
        super().__init__(timeout=_GOODBYE, autoping=False, max_msg_size=_READ_AT_MOST, compress=False)

    async def close(self, *, code: int = LEAVING, message: bytes = b"", drain: bool = True) -> bool:
        if code in _MADE_BY_LIBRARY:
            code, message = BAD_MESSAGE, _MADE_BY_LIBRARY[code].encode()
        return await super().close(code=code, message=message, drain=drain)


class Connection:
    """Of the event loop's thread."""

    def __init__(
        self,
        page: int,
        device: str,
        address: str,
        cookie: str,
        put: Callable[[Event], None],
        end_page: Callable[[int, str], object],
        limits: Limits,
        now: float,
    ) -> None:
        """`cookie`: of its session; empty: it watches only. `end_page` ends a page by its number, and for whom."""
        self.page = page
        self.device = device
        self.address = address
        self.cookie = cookie
        self.socket = Socket()
        self._put = put
        self._end_page = end_page
        self._opened = now
        self._limits = limits
        self._rate = Rate(limits.rate, now)
        self._send_window = SendWindow()
        self._sent = -1
        self._state: Shown | None = None
        self._picture: bytes | None = None
        self._newest: dict[type, bytes] = {}
        """Route and plan that wait. Older ones say nothing any more."""
        self._told: deque[bytes] = deque(maxlen=_MOST_TOLD)
        self._greeted = False
        self._silenced = False
        self.dropping: asyncio.Task[None] | None = None
        """Its end, where the service has begun that."""
        self._news = asyncio.Event()
        self._loop = asyncio.get_running_loop()

    @property
    def may_drive(self) -> bool:
        return bool(self.cookie)

    def offer(self, state: Shown) -> None:
        """The newest there is, in the place of one that still waits."""
        self._state = state
        self._news.set()

    def row(self, now: float) -> OpenPage:
        """This page, as others are told of it."""
        return OpenPage(page=self.page, device=self.device, may_drive=self.may_drive, age=now - self._opened)

    def send(self, message: ForOnePage | OpenPages) -> None:
        self._greeted = self._greeted or isinstance(message, Hello)
        if isinstance(message, Looking) and not message.on:
            self._picture = None  # it looks no longer, and its link may be slow
        if isinstance(message, Plan | Route):
            self._newest[type(message)] = msgspec.json.encode(message)
        else:
            self._told.append(msgspec.json.encode(message))
        self._news.set()

    def send_picture(self, data: bytes) -> None:
        self._picture = data
        self._news.set()

    def is_silent(self, now: float) -> bool:
        return self._send_window.waits(now) >= self._limits.silent

    def silence(self) -> None:
        """Its hand counts no more; it may still say stop."""
        self._silenced = True

    async def serve(self) -> None:
        """Until either side has closed it. The socket is prepared."""
        writing = asyncio.create_task(self._write())
        try:
            await self._read()
        finally:
            writing.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await writing

    async def end(self, code: int, reason: str) -> None:
        """Close it, and wait a moment for the page to do so, too."""
        await bounded(self.socket.close(code=code, message=reason.encode()[:_LONGEST_REASON]))

    async def _read(self) -> None:
        while True:
            message = await self.socket.receive()
            match message.type:
                case WSMsgType.TEXT:
                    fault = self._on_text(message.data)
                case WSMsgType.PING | WSMsgType.PONG:  # they count as all that a page says
                    fault = self._too_many(self._loop.time())
                    if not fault and message.type is WSMsgType.PING:
                        with contextlib.suppress(ConnectionError):  # the next message tells that it has gone
                            await self.socket.pong(message.data)
                case WSMsgType.BINARY:
                    fault = "a message is JSON text, and no binary data"
                case _:
                    return
            if fault:
                await self.end(BAD_MESSAGE, fault)
                return

    def _on_text(self, text: str) -> str:
        """What is wrong with what the page has said; empty: it is done."""
        data = text.encode()
        if len(data) > LARGEST:
            return _MADE_BY_LIBRARY[1009]
        try:
            said = _decoder.decode(data)
        except (msgspec.MsgspecError, ValueError, RecursionError) as error:
            return f"not a message of a page: {plain(error)}"
        now = self._loop.time()
        if isinstance(said, Stop):
            self._put(StopAsked(self.device, said.off))  # before its rate is looked at
        if fault := self._too_many(now):
            return fault
        if isinstance(said, StateSeen):
            if said.n > self._sent:
                return f"no state {said.n} was sent here"
            self._send_window.seen(said.n, now)
            self._news.set()
        elif not isinstance(said, Stop) and (self.may_drive or isinstance(said, RouteCancel)) and not self._silenced:
            if isinstance(said, End):
                self._end_page(said.page, self.device)
            else:
                self._put(Said(self.page, said))
        return ""

    def _too_many(self, now: float) -> str:
        """Count one message of the page; empty: it may say that many."""
        return "" if self._rate.admit(now) else f"more than {self._limits.rate:g} messages a second"

    async def _write(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            while (found := self._next()) is not None:
                # As bytes: it is encoded once, for all pages.
                await self.socket.send_frame(*found)

    def _next(self) -> tuple[bytes, WSMsgType] | None:
        """Return the next frame. Plan and picture wait for all else: they take a slow link for long."""
        if self._told:
            return self._told.popleft(), WSMsgType.TEXT
        if not self._greeted or not self._send_window.allows():
            return None
        if self._state is not None:
            state, self._state = self._state, None
            self._sent = state.n
            self._send_window.sent(state.n, self._loop.time())
            return state.data, WSMsgType.TEXT
        if self._newest:
            return self._newest.pop(Route if Route in self._newest else Plan), WSMsgType.TEXT
        picture, self._picture = self._picture, None
        return None if picture is None else (picture, WSMsgType.BINARY)


async def bounded(closing: Awaitable[object]) -> None:
    """Close without waiting longer than a moment, whatever the other side does."""
    with contextlib.suppress(TimeoutError, ConnectionError, RuntimeError):
        async with asyncio.timeout(_GOODBYE):
            await closing
