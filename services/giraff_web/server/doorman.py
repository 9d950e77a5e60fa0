"""TCP connections before and around HTTP: how many there may be, and how long one may do nothing.

asyncio's own server says nothing of who calls before TLS is agreed on, and aiohttp's waits for a first request for
ever. So connections are taken here. Where there are too many the one that has asked nothing for longest goes, never a
page that is open: a crowd of idle ones keeps no STOP out.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl
from collections import Counter
from collections.abc import Callable
from typing import Any, Final

from giraff_web.limits import Limits

_LOOK: Final = 0.5  # s
_GOODBYE: Final = 1.0  # s that the other side has to close its side
_AFTER_TROUBLE: Final = 0.2  # s; no descriptor was free


class Guarded(asyncio.Protocol):
    """Stands between a connection and its HTTP, and knows what it is good for."""

    def __init__(
        self, inner: asyncio.Protocol, connection: socket.socket, now: float, ended: Callable[[Guarded], None]
    ) -> None:
        self.inner = inner
        self._connection = connection
        self._ended = ended
        self.address = _address(connection.getpeername)
        self.own_address = _address(connection.getsockname)
        """Of this host, at which it was reached."""
        self.is_page = False
        """It is the WebSocket of a page that was let in."""
        self.asked_at = now
        """When its last request began."""
        self.transport: asyncio.BaseTransport | None = None
        self.opening: asyncio.Task[None] | None = None

    def end(self) -> None:
        """At once, whatever waits to be written."""
        with contextlib.suppress(OSError):  # the other side was quicker
            self._connection.shutdown(socket.SHUT_RDWR)  # which ends a handshake, too
        if isinstance(self.transport, asyncio.Transport) and not self.transport.is_closing():
            self.transport.abort()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = transport
        self.inner.connection_made(transport)

    def data_received(self, data: bytes) -> None:
        self.inner.data_received(data)

    def eof_received(self) -> bool | None:
        return self.inner.eof_received()

    def pause_writing(self) -> None:
        self.inner.pause_writing()

    def resume_writing(self) -> None:
        self.inner.resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        self.inner.connection_lost(exc)
        self._ended(self)


class Doorman:
    """Takes the connections of one listening socket. Of its event loop's thread."""

    def __init__(
        self, listener: socket.socket, context: ssl.SSLContext, http: Callable[[], asyncio.Protocol], limits: Limits
    ) -> None:
        self._listener = listener
        self._context = context
        self._http = http
        self._limits = limits
        self._loop = asyncio.get_running_loop()
        self._inside: dict[asyncio.Protocol, Guarded] = {}  # by their HTTP

    def __len__(self) -> int:
        return len(self._inside)

    def of(self, http: asyncio.BaseProtocol | None) -> Guarded | None:
        """The connection of this HTTP; None: it has ended."""
        return self._inside.get(http) if isinstance(http, asyncio.Protocol) else None

    async def run(self) -> None:
        """Until it is cancelled."""
        async with asyncio.TaskGroup() as both:
            both.create_task(self._take())
            both.create_task(self._look())

    def close(self) -> None:
        for guarded in list(self._inside.values()):
            guarded.end()

    async def _take(self) -> None:
        while True:
            try:
                connection, _ = await self._loop.sock_accept(self._listener)
            except OSError:
                await asyncio.sleep(_AFTER_TROUBLE)
                continue
            guarded = Guarded(self._http(), connection, self._loop.time(), self._forget)
            if not self._make_room(guarded.address):
                connection.close()
                continue
            self._inside[guarded.inner] = guarded
            guarded.opening = asyncio.create_task(self._open(guarded, connection))

    async def _open(self, guarded: Guarded, connection: socket.socket) -> None:
        try:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            await self._loop.connect_accepted_socket(
                lambda: guarded,
                connection,
                ssl=self._context,
                ssl_handshake_timeout=self._limits.idle,
                ssl_shutdown_timeout=_GOODBYE,
            )
        except (OSError, asyncio.CancelledError):  # it speaks no TLS, does not trust this certificate, or is sent away
            self._forget(guarded)
            with contextlib.suppress(OSError):
                connection.close()

    def _make_room(self, address: str) -> bool:
        """Whether one more may come in, for which an idle one goes where need be."""
        counts = Counter(each.address for each in self._inside.values())
        if counts[address] >= self._limits.of_one_address:
            return self._send_away(address)
        if len(self._inside) >= self._limits.connections:
            return any(self._send_away(crowd) for crowd, _ in counts.most_common())
        return True

    def _send_away(self, address: str) -> bool:
        idle = [each for each in self._inside.values() if each.address == address and not each.is_page]
        if not idle:
            return False
        oldest = min(idle, key=lambda each: each.asked_at)
        self._forget(oldest)
        oldest.end()
        return True

    def _forget(self, guarded: Guarded) -> None:
        self._inside.pop(guarded.inner, None)

    async def _look(self) -> None:
        while True:
            await asyncio.sleep(_LOOK)
            now = self._loop.time()
            for guarded in [each for each in self._inside.values() if not each.is_page]:
                if now - guarded.asked_at >= self._limits.idle:
                    guarded.end()


def _address(asked: Callable[[], Any]) -> str:
    try:
        return str(asked()[0])
    except OSError:  # it has gone already
        return ""
