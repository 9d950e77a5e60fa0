"""A web server with a service that answers it as the real one does, and browsers that are aiohttp's client."""

import asyncio
import json
import socket
import ssl
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import asynccontextmanager, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import aiohttp
import msgspec

from giraff_node.process.unix_socket import listen_at
from giraff_schemas.trouble import NO_TROUBLE
from giraff_web.config import WebConfig
from giraff_web.limits import Limits
from giraff_web.messages import Hello, State
from giraff_web.pages import Event, Opened
from giraff_web.server.certificates import made_certificate, own_names
from giraff_web.server.host import RIGHTS, HostSocket, own_socket
from giraff_web.server.server import Server, Site

STATE = State(
    n=0, tick=None, age=0.0, operator="", device="", page=0, armed=None, why=NO_TROUBLE, stop=None,
    stop_outcome=NO_TROUBLE,
    directions=None, evidence={}, pose=None, covariance=None, segment="", speed=None, path=None, battery=None,
    round_trip=None,
)  # fmt: skip
HOST = "127.0.0.1"
IPHONE = f"iPhone at {HOST}"
STOP = '{"type": "stop"}'
LIMITS = Limits()
PHONE = "Mozilla/5.0 (iPhone; CPU iPhone OS 18_1 like Mac OS X)"


class Desk:
    """The server, and all that its pages have said to the service."""

    def __init__(self, server: Server, authority: bytes) -> None:
        self.server = server
        self.authority = authority
        self.events: list[Event] = []
        self.log: list[str] = []
        self.announced: list[list[str]] = []
        self.failures: list[BaseException] = []
        self.n = 0

    @property
    def url(self) -> str:
        return f"https://{HOST}:{self.server.port}"

    def turn(self) -> None:
        for event in self.server.poll():
            self.events.append(event)
            if isinstance(event, Opened):
                self.server.send(event.page, hello(event))

    def show(self, states: int = 1) -> None:
        """The next states of the robot."""
        for _ in range(states):
            self.n += 1
            self.server.show(msgspec.structs.replace(STATE, n=self.n))

    async def until(self, holds: Callable[[], object], within: float = 20.0) -> None:
        """Turn until it holds."""
        ends = time.monotonic() + within
        while not holds():
            assert time.monotonic() < ends, f"not within {within:g} s: {self.events} {self.log}"
            await asyncio.sleep(0.005)
            self.turn()

    def of(self, kind: type[Event]) -> list[Any]:
        """The events of this kind."""
        return [event for event in self.events if isinstance(event, kind)]


def hello(page: Opened) -> Hello:
    return Hello(
        page=page.page, device=page.device, may_drive=page.may_drive, robot="one", radius=0.3, track=0.4,
        slow_speed=0.3, trail=(),
    )  # fmt: skip


@contextmanager
def desk(state: Path, *, strangers_watch: bool = True, limits: Limits = LIMITS, **fields: Any) -> Iterator[Desk]:
    """A server at a port of its own, whose certificate is kept below `state`. `fields`: of its configuration."""
    names = own_names("desk", [HOST, "127.0.0.2"], ())
    certificate, _ = made_certificate(state, "desk", names, datetime.now(UTC))
    site = Site(certificate, tuple(map(str, names)), (HOST,), strangers_watch)
    log: list[str] = []
    announced: list[list[str]] = []
    failures: list[BaseException] = []
    config = WebConfig(**{"port": 0, **fields})
    host = HostSocket("one", listen_at(own_socket({"RUNTIME_DIRECTORY": str(state)}), RIGHTS))
    server = Server(config, site, announced.append, log.append, failures.append, limits, host)
    it = Desk(server, certificate.authority)
    it.log, it.announced, it.failures = log, announced, failures
    try:
        server.start()
        yield it
    finally:
        server.close()
        host.listener.close()
    assert failures == []


@asynccontextmanager
async def browser(
    of: Desk, *, address: str = HOST, agent: str = PHONE, trusting: bytes = b""
) -> AsyncIterator[aiohttp.ClientSession]:
    """One with cookies of its own, which trusts the certificate that it was given. `address`: it calls from."""
    context = ssl.create_default_context(cadata=(trusting or of.authority).decode())
    sockets: list[socket.socket] = []

    def new_socket(found: tuple[Any, ...]) -> socket.socket:
        made = socket.socket(found[0], found[1], found[2])
        made.setblocking(False)
        made.bind((address, 0))
        sockets.append(made)
        return made

    try:
        async with aiohttp.ClientSession(
            connector=aiohttp.TCPConnector(ssl=context, socket_factory=new_socket, limit=0),
            cookie_jar=aiohttp.CookieJar(unsafe=True),  # of an address, too
            headers={"User-Agent": agent},
        ) as session:
            yield session
    finally:
        # The client goes on closing its connections after it has ended.
        await of.until(lambda: all(each.fileno() < 0 for each in sockets))


async def sign_in(of: Desk, session: aiohttp.ClientSession, token: str = "") -> tuple[int, dict[str, str]]:
    """Show a token, or the open one."""
    async with session.post(f"{of.url}/session", json={"token": token or of.server.token}) as answer:
        return answer.status, await answer.json()


@asynccontextmanager
async def page(of: Desk, session: aiohttp.ClientSession) -> AsyncIterator[aiohttp.ClientWebSocketResponse]:
    """An open WebSocket, whatever it is told."""
    async with session.ws_connect(f"{of.url}/ws", autoclose=True) as socket:
        yield socket


async def told(socket: aiohttp.ClientWebSocketResponse) -> dict[str, Any]:
    """The next message."""
    found = await asyncio.wait_for(socket.receive_json(), 20.0)
    assert isinstance(found, dict)
    return found


async def closed(socket: aiohttp.ClientWebSocketResponse) -> tuple[int, str]:
    """With which code and reason it is closed, whatever comes before."""
    while True:
        message = await asyncio.wait_for(socket.receive(), 20.0)
        if message.type is aiohttp.WSMsgType.CLOSE:
            return message.data, message.extra or ""
        assert message.type is aiohttp.WSMsgType.TEXT, message


def trying(state: Path, course: Callable[[Desk], Coroutine[Any, Any, None]], **settings: Any) -> None:
    """Run a course of things against a server of its own."""
    with desk(state, **settings) as it:
        asyncio.run(asyncio.wait_for(course(it), 60.0))


def wish(n: int) -> str:
    """Of a hand on the pad."""
    return json.dumps({"type": "wish", "n": n, "tick": ["1", "5"], "hold": 1, "input": "pad", "forward": 0.5})
