"""Runs on a machine of the lab and floods a door: python flood.py KIND HOST PORT ...

Prints {"open": connections that are open, "made": all that came about so far} again and again. It ends when it is
killed; the kinds `peers` and `leaves` come once.
"""

import asyncio
import contextlib
import itertools
import json
import os
import resource
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final, NamedTuple

import zenoh

_TELLS_EVERY: Final = 0.2  # s
_MOST_FILES: Final = 12_000


class Raw(NamedTuple):
    """Connections that speak no Zenoh."""

    held: int
    """How many are kept open. One that the other side closes is made again."""
    rate: float = 0.0
    """Connections a second that are made besides."""
    says: bytes = b""
    every: float | None = None
    """s after which a connection says so again; None: never."""


class Sessions(NamedTuple):
    """True Zenoh sessions."""

    mode: str
    held: int
    stay: float
    """s until each of them leaves."""
    come_again: bool


KINDS: Final[dict[str, Raw | Sessions]] = {
    "half-open": Raw(held=5000),
    "garbage": Raw(held=0, rate=120.0, says=b"\xff" * 512),
    "slow": Raw(held=1000, says=b"\x20", every=1.0),
    "clients": Sessions("client", held=200, stay=5.0, come_again=True),
    "peers": Sessions("peer", held=20, stay=2.5, come_again=False),
    "leaves": Sessions("peer", held=1, stay=3.0, come_again=False),
    "stays": Sessions("peer", held=1, stay=3600.0, come_again=False),
}


class Flood:
    """Connections to one host."""

    def __init__(self, host: str, ports: list[int]) -> None:
        self._open = self._made = 0
        self._doors = itertools.cycle((host, port) for port in ports)

    async def run(self, kind: Raw | Sessions) -> None:
        telling = asyncio.create_task(self._tell())
        if isinstance(kind, Raw):
            await asyncio.gather(self._make(kind), *(self._keep(kind) for _ in range(kind.held)))
        else:
            asyncio.get_running_loop().set_default_executor(ThreadPoolExecutor(kind.held))
            await asyncio.gather(*(asyncio.to_thread(self._visit, kind) for _ in range(kind.held)))
        telling.cancel()

    async def _keep(self, kind: Raw) -> None:
        while True:
            await self._connect(kind)

    async def _make(self, kind: Raw) -> None:
        made: set[asyncio.Task[None]] = set()
        while kind.rate:
            made.add(task := asyncio.create_task(self._connect(kind)))
            task.add_done_callback(made.discard)
            await asyncio.sleep(1 / kind.rate)

    async def _connect(self, kind: Raw) -> None:
        """Open a connection, and keep it until the other side closes it."""
        try:
            heard, says = await asyncio.open_connection(*next(self._doors))
        except OSError:
            await asyncio.sleep(0.1)
            return
        is_open = True
        with self._counted(), contextlib.suppress(OSError):
            while is_open:
                says.write(kind.says)
                with contextlib.suppress(TimeoutError):
                    is_open = bool(await asyncio.wait_for(heard.read(4096), kind.every))
        says.close()

    def _visit(self, kind: Sessions) -> None:
        while True:
            with contextlib.suppress(zenoh.ZError), zenoh.open(self._config(kind)), self._counted():
                time.sleep(kind.stay)
            if not kind.come_again:
                return

    def _config(self, kind: Sessions) -> zenoh.Config:
        host, port = next(self._doors)
        config: dict[str, Any] = {
            "mode": kind.mode,
            "connect": {"endpoints": [f"tcp/{host}:{port}"]},
            "scouting": {"multicast": {"enabled": False}},
        }
        return zenoh.Config.from_json5(json.dumps(config))

    @contextlib.contextmanager
    def _counted(self) -> Iterator[None]:
        self._open += 1
        self._made += 1
        try:
            yield
        finally:
            self._open -= 1

    async def _tell(self) -> None:
        while True:
            print(json.dumps({"open": self._open, "made": self._made}), flush=True)
            await asyncio.sleep(_TELLS_EVERY)


if __name__ == "__main__":
    os.nice(19)  # it has a processor of its own, elsewhere
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(_MOST_FILES, hard), hard))
    name, at, *numbers = sys.argv[1:]
    asyncio.run(Flood(at, [int(number) for number in numbers]).run(KINDS[name]))
