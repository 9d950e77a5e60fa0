"""TCP connections before and around HTTP: how many there may be, and how long one may do nothing.

asyncio's own server says nothing of who calls before TLS is agreed on, and aiohttp's waits for a first request for
ever. So connections are taken here. Each is in one of three crowds, which take no room from each other: it has sent
nothing or plain HTTP, its TLS handshake is under way, or it has agreed on TLS. So a crowd that asks nothing keeps no
STOP out, and a request that is under way is never sent away.
"""

import asyncio
import contextlib
import socket
import ssl
from collections.abc import Callable
from typing import Any, Final

from giraff_web.limits import Limits
from giraff_web.server.crowd import Crowd

_LOOK: Final = 0.5  # s
_GOODBYE: Final = 1.0  # s that the other side has to close its side
_AFTER_TROUBLE: Final = 0.2  # s; no descriptor was free
_HANDSHAKE: Final = b"\x16"
"""First byte of each TLS connection."""
_METHODS: Final = b"CDGHOPT"
"""First letters of the methods of HTTP, which a browser speaks where somebody types no https."""
_LONGEST: Final = 16_384
"""Bytes of plain HTTP that are read at most."""
_PLAIN: Final = (
    "HTTP/1.1 400 Bad Request\r\n"
    "Content-Type: text/plain\r\nContent-Length: {length}\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n{line}"
)


class Guarded(asyncio.Protocol):
    """Stands between a connection and its HTTP, and knows what it is good for."""

    def __init__(self, connection: socket.socket, now: float, limiter: "ConnectionLimiter") -> None:
        self.connection = connection
        self.inner = asyncio.Protocol()
        """Its HTTP; before TLS is agreed on it does nothing."""
        self._limiter = limiter
        self.address = _address(connection.getpeername)
        self.own_address = _address(connection.getsockname)
        """Of this host, at which it was reached."""
        self.is_busy = False
        """A request that has come whole is under way, or it is the WebSocket of a page."""
        self.since = now
        """When it was accepted, or its last request began or ended."""
        self.transport: asyncio.BaseTransport | None = None
        self.opening: asyncio.Task[None] | None = None
        self.crowd: Crowd[Guarded] | None = None
        self.unread = _LONGEST
        """Bytes of plain HTTP that may still come."""

    def end(self) -> None:
        """At once, whatever waits to be written."""
        self._limiter.forget(self)
        if self.opening is None:
            self._limiter.close_bare(self)
            return
        with contextlib.suppress(OSError):  # the other side was quicker
            self.connection.shutdown(socket.SHUT_RDWR)  # which ends a handshake, too
        if isinstance(self.transport, asyncio.Transport) and not self.transport.is_closing():
            self.transport.abort()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = transport
        self._limiter.let_in(self)
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
        self._limiter.forget(self)


class ConnectionLimiter:
    """Takes the connections of one listening socket. Of its event loop's thread."""

    def __init__(
        self, listener: socket.socket, context: ssl.SSLContext, http: Callable[[], asyncio.Protocol], limits: Limits
    ) -> None:
        self._listener = listener
        self._context = context
        self._http = http
        self._loop = asyncio.get_running_loop()
        self.bare: Crowd[Guarded] = Crowd(limits.bare)
        self.handshakes: Crowd[Guarded] = Crowd(limits.handshakes)
        self.connections: Crowd[Guarded] = Crowd(limits.connections)
        self._crowds = self.bare, self.handshakes, self.connections
        self._by_http: dict[asyncio.Protocol, Guarded] = {}

    def __len__(self) -> int:
        return sum(map(len, self._crowds))

    def of(self, http: asyncio.BaseProtocol | None) -> Guarded | None:
        """The connection of this HTTP; None: it has ended."""
        return self._by_http.get(http) if isinstance(http, asyncio.Protocol) else None

    async def run(self) -> None:
        """Until it is cancelled."""
        async with asyncio.TaskGroup() as both:
            both.create_task(self._accept())
            both.create_task(self._watch())

    def close(self) -> None:
        for crowd in self._crowds:
            crowd.end_all()

    def let_in(self, guarded: Guarded) -> None:
        """Give it its HTTP: TLS is agreed on. It ends where there is no room."""
        if self._move(guarded, self.connections):
            guarded.inner = self._http()
            self._by_http[guarded.inner] = guarded
        else:
            guarded.end()

    def forget(self, guarded: Guarded) -> None:
        """It ends."""
        self._by_http.pop(guarded.inner, None)
        if guarded.crowd is not None:
            guarded.crowd.leave(guarded)

    def close_bare(self, guarded: Guarded) -> None:
        self._loop.remove_reader(guarded.connection)
        guarded.connection.close()

    async def _accept(self) -> None:
        while True:
            await asyncio.sleep(0)  # whoever is inside comes between two that call
            try:
                connection, _ = await self._loop.sock_accept(self._listener)
            except OSError:
                await asyncio.sleep(_AFTER_TROUBLE)
                continue
            guarded = Guarded(connection, self._loop.time(), self)
            self._loop.add_reader(connection, self._begin_tls, guarded)
            if self._move(guarded, self.bare):
                self._begin_tls(guarded)  # mostly it has said something by now
            else:
                guarded.end()

    def _begin_tls(self, guarded: Guarded) -> None:
        """Begin TLS once there is a first byte of it: before that a connection gets no buffers."""
        try:
            first = guarded.connection.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return
        except OSError:
            first = b""
        if first == _HANDSHAKE and self._move(guarded, self.handshakes):
            self._loop.remove_reader(guarded.connection)
            guarded.opening = asyncio.create_task(self._open(guarded))
        elif first and first in _METHODS:
            self._refuse_plain(guarded)
        else:
            guarded.end()

    def _refuse_plain(self, guarded: Guarded) -> None:
        """Tell the address with https. It is of this socket: the request may name any host."""
        connection = guarded.connection
        self._loop.add_reader(connection, self._read_out, guarded)
        try:
            address = f"{in_address(guarded.own_address)}:{connection.getsockname()[1]}"
            line = f"This page speaks https: open https://{address}/\n"
            connection.send(_PLAIN.format(length=len(line), line=line).encode())
            connection.shutdown(socket.SHUT_WR)
        except OSError:
            guarded.end()

    def _read_out(self, guarded: Guarded) -> None:
        """Read until the caller closes it: bytes that nobody reads reset a connection, and its answer is lost."""
        try:
            data = guarded.connection.recv(_LONGEST)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        guarded.unread -= len(data)
        if not data or guarded.unread <= 0:
            guarded.end()

    async def _open(self, guarded: Guarded) -> None:
        connection = guarded.connection
        try:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            await self._loop.connect_accepted_socket(
                lambda: guarded,
                connection,
                ssl=self._context,
                ssl_handshake_timeout=self.handshakes.allowance.patience,
                ssl_shutdown_timeout=_GOODBYE,
            )
        except (OSError, asyncio.CancelledError) as error:
            # It speaks no TLS, does not trust this certificate, or is sent away. The traceback and asyncio's own frame
            # refer to each other: they would keep the TLS buffers until the garbage is collected.
            error.__traceback__ = None
        if guarded.transport is None:
            self.forget(guarded)
            connection.close()

    def _move(self, guarded: Guarded, crowd: Crowd[Guarded]) -> bool:
        """Whether that crowd has taken it."""
        if guarded.crowd is not None:
            guarded.crowd.leave(guarded)
        guarded.crowd = crowd if crowd.enter(guarded) else None
        return guarded.crowd is not None

    async def _watch(self) -> None:
        while True:
            await asyncio.sleep(_LOOK)
            for crowd in self._crowds:
                crowd.end_late(self._loop.time())


def in_address(name: str) -> str:
    """Return it as it stands in a web address: an IPv6 address in brackets."""
    return f"[{name}]" if ":" in name else name


def _address(asked: Callable[[], Any]) -> str:
    try:
        return str(asked()[0])
    except OSError:  # it has gone already
        return ""
