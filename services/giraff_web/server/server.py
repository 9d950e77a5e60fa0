"""`Pages` over HTTPS and WebSockets: a thread of its own, with its own event loop, beside the service's turn."""

import asyncio
import contextlib
import errno
import logging
import secrets
import socket
import threading
from collections.abc import Callable, Iterable
from itertools import count
from typing import Any, Final, NamedTuple

import msgspec
from aiohttp import web

from giraff_node.process.selector import Waker
from giraff_schemas.messages import EStop
from giraff_web.config import WebConfig
from giraff_web.event_box import EventBox
from giraff_web.limits import Limits
from giraff_web.messages import OpenPages, State
from giraff_web.pages import Closed, Event, ForOnePage, Opened, StopAsked
from giraff_web.server.certificates import Certificate
from giraff_web.server.connection import ENDED, LEAVING, NOT_ALLOWED, SILENT, TOO_MANY, Connection, Shown, bounded
from giraff_web.server.connection_limiter import ConnectionLimiter, in_address
from giraff_web.server.host import Answer, Ask, HostSocket, serve
from giraff_web.server.requests import Requests
from giraff_web.server.stop_answers import StopAnswers
from giraff_web.sessions import Sessions

_LOOK: Final = 0.5  # s between looks at what is silent or over
_ENDS_WITHIN: Final = 3.0  # s
_BACKLOG: Final = 128
_ENDED: Final = "this page was ended; reload it to watch, or open the address that the page service shows now to drive"
"""At most 120 bytes, as each reason of a close."""
_TOKEN_BYTES: Final = 18
"""144 bits, and no padding in base64."""

Announce = Callable[[list[str]], None]


class PortError(Exception):
    """There is no port to listen at; the text says why, with the way out."""


class Site(NamedTuple):
    """Who this host is to browsers."""

    certificate: Certificate
    names: tuple[str, ...]
    """By which it may be asked for."""
    reached_at: tuple[str, ...]
    """By which others reach it: they are told to people."""
    strangers_watch: bool = True
    """Whether a page without a session is let in."""
    robot: str = ""
    """Name of the robot that the pages drive and stop; each answer tells it."""


class Server:
    """The pages that are open. `announce` takes the addresses to open, each time they have become others, in a thread
    of its own; `log` and `fail`, with what has ended the server, are called in the server's thread."""

    def __init__(
        self,
        config: WebConfig,
        site: Site,
        announce: Announce,
        log: Callable[[str], None],
        fail: Callable[[BaseException], None],
        limits: Limits = Limits(),  # noqa: B008  it is frozen
        host: HostSocket | None = None,
    ) -> None:
        """`host`: where commands of this host ask for the open pages."""
        self._config = config
        self._site = site
        self._announce = announce
        self._log = log
        self._fail = fail
        self._limits = limits
        self._host = host
        self._sessions = Sessions(lambda: secrets.token_urlsafe(_TOKEN_BYTES))
        self._numbers = count(1)
        self._connections: dict[int, Connection] = {}
        self._listed: frozenset[int] = frozenset()  # the pages that drivers were told of
        self._driver = 0
        self._box = EventBox()
        self._stop_answers = StopAnswers(limits.stops)
        self._lock = threading.Lock()
        self._waker = Waker()
        self._woken = False
        self._shown: Shown | None = None
        self._showing = False
        self._listener: socket.socket | None = None
        self._connection_limiter: ConnectionLimiter | None = None
        self._requests: Requests | None = None
        self._loop = asyncio.new_event_loop()
        self._ending = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="pages", daemon=True)

    @property
    def port(self) -> int:
        """That it listens at."""
        assert self._listener is not None  # noqa: S101  it was started
        return int(self._listener.getsockname()[1])

    @property
    def token(self) -> str:
        """That opens the next session."""
        return self._sessions.token

    def start(self) -> None:
        """Listen, and tell where. Raises PortError."""
        self._listener = _listening(self._config)
        self._thread.start()
        self._tell_addresses()

    def close(self) -> None:
        """End it, within a few seconds. It was started, or not."""
        if self._thread.is_alive():
            self._call(self._ending.set)
            self._thread.join(_ENDS_WITHIN)
        elif self._listener is None:
            self._loop.close()
        if not self._thread.is_alive():
            self._waker.close()

    def descriptor(self) -> int | None:
        return self._waker.descriptor()

    def poll(self) -> Iterable[Event]:
        with self._lock:
            if self._woken:
                self._waker.drain()
                self._woken = False
            self._stop_answers.turns += 1
            return self._box.pop_all()

    def show(self, state: State) -> None:
        self._shown = Shown(state.n, msgspec.json.encode(state))
        self._driver = state.page
        if not self._showing:
            self._showing = True
            self._call(self._spread)

    def confirm(self, word: EStop) -> None:
        if self._stop_answers.is_waited:
            self._call(self._stop_answers.give, word, self._stop_answers.turns)

    def send(self, page: int, message: ForOnePage) -> None:
        self._call(self._send, page, message)

    def send_picture(self, page: int, data: bytes) -> None:
        self._call(self._send_picture, page, data)

    def _call(self, function: Callable[..., object], *arguments: Any) -> None:
        with contextlib.suppress(RuntimeError):  # it has ended
            self._loop.call_soon_threadsafe(function, *arguments)

    def _put(self, event: Event) -> None:
        with self._lock:
            self._box.put(event)
            if not self._woken:
                self._woken = True
                self._waker.wake()

    def _spread(self) -> None:
        self._showing = False  # first: what comes from here on is spread once more
        if self._shown is not None:
            for connection in self._connections.values():
                connection.offer(self._shown)

    def _send(self, page: int, message: ForOnePage) -> None:
        if connection := self._connections.get(page):
            connection.send(message)

    def _send_picture(self, page: int, data: bytes) -> None:
        if connection := self._connections.get(page):
            connection.send_picture(data)

    def _run(self) -> None:
        try:
            with asyncio.Runner(loop_factory=lambda: self._loop) as runner:
                runner.run(self._serve())
        except BaseException as error:  # noqa: BLE001  whoever watches over the process is to know
            self._fail(error)

    async def _serve(self) -> None:
        assert self._listener is not None  # noqa: S101  it was started
        quiet = logging.getLogger("giraff_web.http")
        quiet.setLevel(logging.CRITICAL)  # it would tell each broken request of any stranger
        http = web.Server(self._answer, access_log=None, logger=quiet, lingering_time=1.0)
        self._connection_limiter = limiter = ConnectionLimiter(
            self._listener, self._site.certificate.context, http, self._limits
        )
        self._requests = Requests(
            self._sessions,
            self,
            limiter.of,
            names=self._site.names,
            authority=self._site.certificate.authority,
            used=self._on_used,
            log=self._log,
        )
        self._loop.set_exception_handler(lambda _, context: self._log(f"pages: {context.get('message')}"))
        tasks = [asyncio.create_task(each) for each in (limiter.run(), self._watch(), self._ending.wait())]
        if self._host is not None:
            tasks.append(asyncio.create_task(serve(self._host.listener, self._answer_host)))
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        await asyncio.gather(*(each.end(LEAVING, "the service ends") for each in self._connections.values()))
        for task in tasks:
            task.cancel()
        self._listener.close()
        limiter.close()
        await bounded(http.shutdown(1.0))
        for task in done:
            task.result()

    async def _answer(self, request: web.BaseRequest) -> web.StreamResponse:
        assert self._requests is not None  # noqa: S101  made before anybody is let in
        answer = await self._requests.answer(request)
        if not answer.prepared:
            answer.headers["Giraff-Robot"] = self._site.robot
        return answer

    async def _watch(self) -> None:
        """Close the pages that are silent, and those whose session is over. Tell drivers who has come and gone."""
        while True:
            await asyncio.sleep(_LOOK)
            now = self._loop.time()
            for each in list(self._connections.values()):
                if each.is_silent(now):
                    self._drop(each, SILENT, f"the page showed nothing for {self._limits.silent:g} s")
                elif each.may_drive and not self._sessions.device(each.cookie, now):
                    self._drop(each, NOT_ALLOWED, "this session is over; open the address that is shown now")

            if self._listed != self._connections.keys():
                self._listed = frozenset(self._connections)
                pages = OpenPages(pages=tuple(each.row(now) for each in self._connections.values()))
                for each in self._connections.values():
                    if each.may_drive:
                        each.send(pages)

    def _answer_host(self, asked: Ask) -> Answer:
        assert self._host is not None  # noqa: S101  it has asked
        ended = bool(asked.end) and self._end_page(asked.end, "a command on this host")
        pages = tuple(each.row(self._loop.time()) for each in self._connections.values())
        return Answer(robot=self._host.robot, port=self.port, driver=self._driver, pages=pages, ended=ended)

    def _end_page(self, page: int, by: str) -> bool:
        """End it with its session and all pages of that; whether it was open."""
        found = self._connections.get(page)
        if found is None:
            return False
        self._sessions.end(found.cookie)
        for each in list(self._connections.values()):
            if each is found or (found.cookie and each.cookie == found.cookie):
                self._drop(each, ENDED, _ENDED)
        self._log(f"{found.device} was ended by {by}")
        return True

    def _drop(self, connection: Connection, code: int, reason: str) -> None:
        self._forget(connection)  # at once: its hand is gone, whatever it still does
        connection.dropping = asyncio.create_task(connection.end(code, reason))

    async def page(self, request: web.BaseRequest, device: str, cookie: str) -> web.StreamResponse:
        """Serve the WebSocket of a page. `cookie`: of a session; empty: it watches only."""
        now = self._loop.time()
        address = str(request.remote)
        connection = Connection(
            next(self._numbers), device, address, cookie, self._put, self._end_page, self._limits, now
        )
        guarded = self._connection_limiter.of(request.protocol) if self._connection_limiter is not None else None
        if guarded is not None:
            guarded.is_busy = False  # before it is let in
        await connection.socket.prepare(request)
        if not cookie and not self._site.strangers_watch:
            await connection.end(NOT_ALLOWED, "strangers may not watch; open the address that the page service shows")
            return connection.socket
        alike = [each.address for each in self._connections.values() if each.may_drive == connection.may_drive]
        own = alike.count(address)
        if len(alike) >= (self._limits.drivers if cookie else self._config.most_watchers):
            await connection.end(TOO_MANY, f"{len(alike)} pages are open here, and that is the most; close one of them")
            return connection.socket
        if not cookie and own >= self._limits.watchers_of_one_address:
            await connection.end(
                TOO_MANY, f"{own} pages of this address watch, and that is the most; close one of them"
            )
            return connection.socket
        if guarded is None:
            return connection.socket
        guarded.is_busy = True
        self._connections[connection.page] = connection
        self._put(Opened(connection.page, device, connection.may_drive))
        try:
            await connection.serve()
        finally:
            self._forget(connection)
            if connection.dropping is not None:
                await connection.dropping
            if not connection.socket.closed:
                guarded.end()
        return connection.socket

    async def stop(self, device: str, address: str, *, off: bool) -> EStop | None:
        """Ask for the emergency stop, and for off. Return base's word of it, or None where it does not come in time."""
        self._put(StopAsked(device, off))
        return await self._stop_answers.wait(address)

    def _forget(self, connection: Connection) -> None:
        if self._connections.pop(connection.page, None) is not None:
            connection.silence()
            self._put(Closed(connection.page))

    def _on_used(self, device: str) -> None:
        self._log(f"{device} may drive; the next device opens another address")
        self._tell_addresses()

    def _tell_addresses(self) -> None:
        where = [f"https://{in_address(name)}:{self.port}/#{self.token}" for name in self._site.reached_at]
        # A terminal that does not take its text holds up nothing but this.
        threading.Thread(target=self._announce, args=(where,), name="addresses", daemon=True).start()


def _listening(config: WebConfig) -> socket.socket:
    family = socket.AF_INET6 if ":" in config.address else socket.AF_INET
    try:
        listener = socket.create_server((config.address, config.port), family=family, backlog=_BACKLOG)
    except OSError as error:
        raise PortError(_why_not(config, error)) from error
    listener.setblocking(False)
    return listener


def _why_not(config: WebConfig, error: OSError) -> str:
    if isinstance(error, socket.gaierror) or error.errno == errno.EADDRNOTAVAIL:
        return f"[web] address: {config.address!r} is none of this host; leave it empty, and all count"
    if error.errno == errno.EADDRINUSE:
        remedy = "end what listens there (`ss -ltnp` shows it), or choose another by [web] port or --port"
        return f"port {config.port} is in use: {remedy}"
    if error.errno in (errno.EACCES, errno.EPERM):
        return f"port {config.port} is for root only; set [web] port to one above 1023"
    return f"port {config.port}: {error.strerror or error}; set [web] port"
