"""What a browser asks by HTTP, and what it is answered."""

import asyncio
import contextlib
import math
from collections.abc import Awaitable, Callable, Collection
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import PurePosixPath
from typing import Final, NamedTuple, Protocol

import msgspec
from aiohttp import ClientError, web
from aiohttp.http_exceptions import HttpProcessingError

from giraff_schemas.messages import EStop
from giraff_schemas.text import plain
from giraff_web.devices import device_name
from giraff_web.messages import LARGEST
from giraff_web.server.connection_limiter import Guarded
from giraff_web.sessions import SESSION_LIFE, Granted, Sessions

COOKIE: Final = "__Host-giraff"
_HEADERS: Final = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Server": "giraff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "accelerometer=(self), gyroscope=(self), fullscreen=(self), screen-wake-lock=(self), "
    "camera=(), microphone=(), geolocation=()",
}
_CONTENT: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; manifest-src 'self'; "
    "connect-src 'self' wss://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_TYPES: Final = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".json": "application/json",
    ".webmanifest": "application/manifest+json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".ico": "image/x-icon",
}
"""The page's files that are served."""
_STOP: Final = "POST", "/stop"
_NOT_CALLED_SO: Final = "this service is not called so; open the address that the page service shows"
_TOLD_OF_STOP: Final = ("engaged", "off", "id", "by", "reason", "engaged_ns", "instance")
"""Fields of base's word that confirm a stop."""

Answer = web.StreamResponse


class File(NamedTuple):
    """A file of the page, as it is served."""

    data: bytes
    content_type: str


def page_files() -> dict[str, File]:
    """Return the page's files by path below `page`, read once at the start: no request reaches a disk.

    Those of other types are not served.
    """
    return dict(_found(files("giraff_web") / "page", ""))


def _found(folder: Traversable, below: str) -> list[tuple[str, File]]:
    if not folder.is_dir():
        return []
    found = []
    for entry in folder.iterdir():
        name = below + entry.name
        if entry.is_dir():
            found += _found(entry, f"{name}/")
        elif content_type := _TYPES.get(PurePosixPath(name).suffix):
            found.append((name, File(entry.read_bytes(), content_type)))
    return found


class _Shows(msgspec.Struct, frozen=True):
    token: str


class OpensPages(Protocol):
    """What takes a page's WebSocket, and a stop."""

    async def page(self, request: web.BaseRequest, device: str, cookie: str) -> Answer: ...
    async def stop(self, device: str, address: str, *, off: bool) -> EStop | None: ...


class Requests:
    """All that the port answers. Of the event loop's thread."""

    def __init__(
        self,
        sessions: Sessions,
        pages: OpensPages,
        guarded: Callable[[asyncio.BaseProtocol], Guarded | None],
        *,
        names: Collection[str],
        authority: bytes,
        used: Callable[[str], None],
        log: Callable[[str], None],
    ) -> None:
        """`guarded`: the connection of an HTTP. `names`: of this host, small; where it was reached is one, too.

        `authority`: PEM. `used`: called with the device when the token has become another. `log`: takes a line.
        """
        self._sessions = sessions
        self._pages = pages
        self._guarded = guarded
        self._names = frozenset(names)
        self._files = page_files()
        self._authority = authority
        self._used = used
        self._log = log
        self._loop = asyncio.get_running_loop()
        self._routes: dict[tuple[str, str], Callable[[web.BaseRequest], Awaitable[Answer]]] = {
            ("GET", "/"): self._index,
            ("POST", "/session"): self._session,
            ("GET", "/ws"): self._page,
            _STOP: self._stop,
            ("GET", "/ca.crt"): self._certificate,
        }

    async def answer(self, request: web.BaseRequest) -> Answer:
        guarded = self._guarded(request.protocol)
        if guarded is not None:
            guarded.since = self._loop.time()
            guarded.is_busy = request.content.is_eof()  # a body may come for ever
        try:
            answer = await self._answer(request)
        except web.HTTPException as error:  # the library's, of a broken handshake
            why = f"{error.text or error.reason}; open the address that the page service shows"
            answer = _refusal(error.status, why)
        except (HttpProcessingError, ClientError):
            answer = _refusal(400, "the body cannot be read; open the address that the page service shows")
        finally:
            if guarded is not None:
                guarded.since = self._loop.time()
                guarded.is_busy = False
        if not answer.prepared:
            answer.headers.update(_HEADERS)
            answer.headers["Content-Security-Policy"] = _CONTENT.format(host=self._host(request) or "invalid")
        return answer

    async def _answer(self, request: web.BaseRequest) -> Answer:
        # A stop harms nobody, whatever name a router or a former start has given this host.
        is_stop = (request.method, request.path) == _STOP
        host = request.headers.get("Host", "") if is_stop else self._host(request)
        if not (host or is_stop):
            return _refusal(403, _NOT_CALLED_SO)
        if request.headers.get("Origin", f"https://{host}") != f"https://{host}":
            return _refusal(403, "another page asks this; open the address that the page service shows")
        if request.headers.get("Content-Encoding"):
            return _refusal(415, "a body is plain here; open the address that the page service shows")
        if found := self._routes.get((request.method, request.path)):
            return await found(request)
        if request.method == "GET" and request.path.startswith("/page/"):
            return self._file(request.path.removeprefix("/page/"))
        if any(path == request.path for _, path in self._routes):
            return _refusal(405, "not in this way; open the address that the page service shows")
        return _refusal(404, "there is nothing here; open the address that the page service shows")

    def _host(self, request: web.BaseRequest) -> str:
        """Of the request's header, with the port where one is given; empty: it is not this one.

        A page elsewhere can have its own name lead here, and would then be of one origin with this.
        """
        host = request.headers.get("Host", "")
        name, _, port = host.rpartition(":") if not host.endswith("]") and ":" in host else (host, "", "443")
        name = name.strip("[]").lower()
        guarded = self._guarded(request.protocol)
        is_own = name in self._names or (guarded is not None and name == guarded.own_address)
        return host if is_own and port.isascii() and port.isdigit() else ""

    async def _index(self, _request: web.BaseRequest) -> Answer:
        return self._file("index.html")

    def _file(self, name: str) -> Answer:
        file = self._files.get(name)
        if file is None:
            return _refusal(404, f"no file {name[:80]!r} belongs to the page")
        return web.Response(body=file.data, content_type=file.content_type, charset=_charset(file))

    async def _certificate(self, _request: web.BaseRequest) -> Answer:
        return web.Response(body=self._authority, content_type="application/x-x509-ca-cert")

    async def _stop(self, request: web.BaseRequest) -> Answer:
        """Ask for it, and confirm it where base does so in time. A body, if there is one, is not waited for.

        A page elsewhere may have its name lead here, and then asks for no more than a stop.
        """
        off, is_own = "off" in request.query, bool(self._host(request))
        word = await self._pages.stop(_device(request), str(request.remote), off=off and is_own)
        if off and not is_own:
            return _refusal(403, f"the stop is asked for, and off is not: {_NOT_CALLED_SO}")
        if word is None:
            return web.json_response({"asked": True}, status=202)
        told = msgspec.to_builtins(word)
        return web.json_response({"asked": True, "estop": {name: told[name] for name in _TOLD_OF_STOP}})

    async def _session(self, request: web.BaseRequest) -> Answer:
        try:
            token = msgspec.json.decode(await _body(request), type=_Shows).token
        except (msgspec.MsgspecError, ValueError, RecursionError) as error:
            return _refusal(400, f'the body is to be {{"token": "..."}}: {plain(error)}')
        device, address = _device(request), str(request.remote)
        got = self._sessions.redeem(token, device, address, self._loop.time())
        if isinstance(got, Granted):
            answer = web.json_response({"device": device})
            life = int(SESSION_LIFE)
            answer.set_cookie(COOKIE, got.cookie, max_age=life, path="/", secure=True, httponly=True, samesite="Strict")
            self._used(device)
            return answer
        if got.tell:
            self._log(f"{device} may not drive: {got.why}")
        if not got.wait:
            return _refusal(403, got.why)
        answer = _refusal(429, got.why)
        answer.headers["Retry-After"] = str(math.ceil(got.wait))
        return answer

    async def _page(self, request: web.BaseRequest) -> Answer:
        if request.headers.get("Upgrade", "").lower() != "websocket":
            return _refusal(426, "this is for the page's WebSocket; open the address that the page service shows")
        cookie = request.cookies.get(COOKIE, "")
        device = self._sessions.device(cookie, self._loop.time())
        return await self._pages.page(request, _device(request), cookie if device else "")


async def _body(request: web.BaseRequest) -> bytes:
    """Raises ValueError where it is too long."""
    data = b""
    with contextlib.suppress(ConnectionError):
        async for part in request.content.iter_any():
            data += part
            if len(data) > LARGEST:
                raise ValueError(f"it has more than {LARGEST} bytes")
    return data


def _device(request: web.BaseRequest) -> str:
    return device_name(request.headers.get("User-Agent", ""), str(request.remote))


def _refusal(status: int, why: str) -> web.Response:
    return web.json_response({"why": why}, status=status)


def _charset(file: File) -> str | None:
    return None if file.content_type.startswith("image/") else "utf-8"
