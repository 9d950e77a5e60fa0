"""Which pages are open, asked for by commands of the page's own host over a Unix socket, and how one is ended.

The socket's rights let only root and the user of the service connect. A client says one JSON line and is answered one.
"""

import asyncio
import contextlib
import os
import socket
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from giraff_node.process.state import state_directory
from giraff_web.messages import OpenPage

RIGHTS: Final = 0o600
PATIENCE: Final = 2.0
"""s for a client, or for a service that is asked."""
LARGEST: Final = 4096
"""Bytes of what a client asks."""
RUN: Final = Path("/run")
"""Where systemd has the run directories of its units, and of each user."""


class Ask(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A client's request."""

    end: int = 0
    """Number of the page to end; 0: none, the pages are only listed."""


class Answer(msgspec.Struct, frozen=True, kw_only=True):
    """The pages of one service, after what was asked is done."""

    robot: str
    port: int
    driver: int
    """Number of the page that drives; 0: none."""
    pages: tuple[OpenPage, ...]
    ended: bool = False
    """The page to end was open, and is not any more."""


class HostSocket(NamedTuple):
    """The socket that commands of this host ask."""

    robot: str
    listener: socket.socket
    """It listens."""


def run_directory(environment: Mapping[str, str] = os.environ) -> Path:
    """Folder of this user's sockets: $RUNTIME_DIRECTORY, else below $XDG_RUNTIME_DIR, else the XDG state folder."""
    if given := environment.get("RUNTIME_DIRECTORY", "").partition(":")[0]:
        return Path(given)
    user = Path(environment.get("XDG_RUNTIME_DIR", ""))
    return user / "giraff" if user.is_absolute() else _state_folder(environment)


def _state_folder(environment: Mapping[str, str]) -> Path:
    return state_directory("", {name: environment.get(name, "") for name in ("HOME", "XDG_STATE_HOME")})


def own_socket(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the path of this process's socket."""
    return run_directory(environment) / f"page-{os.getpid()}.sock"


def sockets(environment: Mapping[str, str] = os.environ, run: Path = RUN) -> Iterator[Path]:
    """Yield the sockets of this host's page services, also of those that have died.

    A command may have been started without the service's environment, as by ssh or sudo. Root sees all users' folders.
    """
    own = run_directory(environment), _state_folder(environment)
    for folder in dict.fromkeys((*own, *sorted(run.glob("user/*/giraff")), run / "giraff" / "web")):
        yield from sorted(folder.glob("page-*.sock"))


def ask(path: Path, asked: Ask) -> Answer:
    """Ask one service. Raises OSError, and ValueError where what answers is none of this version."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
        client.settimeout(PATIENCE)
        client.connect(os.fspath(path))
        client.sendall(msgspec.json.encode(asked) + b"\n")
        with client.makefile("rb") as answer:
            line = answer.readline()
    if not line:
        raise ConnectionResetError
    return msgspec.json.decode(line, type=Answer)


async def serve(listener: socket.socket, answer: Callable[[Ask], Answer]) -> None:
    """Answer each client once, until this is cancelled."""

    async def on_connection(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        # A client that is slow, gone, or of another version is let go without an answer, and says so itself.
        with contextlib.suppress(TimeoutError, ConnectionError, ValueError, msgspec.MsgspecError):
            async with asyncio.timeout(PATIENCE):
                asked = msgspec.json.decode(await reader.readline(), type=Ask)
                writer.write(msgspec.json.encode(answer(asked)) + b"\n")
                await writer.drain()
        writer.close()

    async with await asyncio.start_unix_server(on_connection, sock=listener, limit=LARGEST) as server:
        await server.serve_forever()
