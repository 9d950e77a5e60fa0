"""Unix sockets at which the robot's own processes on one host meet. No other host reaches them, so they are believed.

Zenoh makes the sockets. Each process has one of its own, with a name that no other host has: a path that is told to
another host leads nowhere there. One more, `rendezvous`, belongs to any of them. Another takes it over when that one
ends.
"""

import contextlib
import errno
import fcntl
import os
import socket
import stat
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.network import NetworkConfig, addresses
from giraff_node.config.robot_file import ConfigError

PROTOCOL: Final = "unixsock-stream"
SHARED: Final = Path("/run/giraff/network")
"""Of the installed services, whose group may use it: `make install` and the image make it."""
_GROUPS: Final = 0o2770  # all files in it belong to the group of the folder above
_LOOPBACK: Final = ("127.0.0.1", "localhost", "[::1]")
_LONGEST: Final = 107  # bytes of a path that Linux takes
_STALE: Final = 60.0  # s; a younger socket may belong to a process that is just starting


def socket_folder(network: NetworkConfig, environment: Mapping[str, str] = os.environ) -> Path:
    """Make, and return, the folder of the sockets of whoever meets at this rendezvous. Raises ConfigError.

    It is that of the installed services where this user may use it, else the user's own.
    """
    parent = Path(network.sockets) if network.sockets else SHARED
    if not network.sockets and not os.access(SHARED, os.W_OK | os.X_OK):
        parent = _own_folder(environment)
    _, _, port = network.rendezvous.rpartition(":")
    folder = parent / port
    if len(os.fsencode(folder / "rendezvous.lock")) > _LONGEST:
        raise ConfigError(f"{folder}: too long for the path of a socket; set sockets in [network] to a shorter one")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found = folder.stat()
        if parent == SHARED and found.st_uid == os.getuid() and stat.S_IMODE(found.st_mode) != _GROUPS:
            folder.chmod(_GROUPS)  # not where it has it: a unit of systemd may not set this bit
    except OSError as error:
        raise ConfigError(
            f"{folder}: {error.strerror}; the processes of this host meet there: "
            "let sockets in [network] name a folder that this user may write to"
        ) from error
    return folder


def own_socket(folder: Path, service: str) -> Path:
    """Return a path for the socket of one process. What dead processes have left there is removed."""
    remove_stale_sockets(folder)
    return folder / f"{service[:12]}-{os.urandom(4).hex()}"


def remove_stale_sockets(folder: Path, after: float = _STALE) -> None:
    """Remove what processes that have been dead for `after` s have left in a folder of sockets."""
    for lock in folder.glob("*.lock"):
        with contextlib.suppress(OSError):
            _remove_stale(lock, after)


def live_sockets(folder: Path) -> tuple[str, ...]:
    """Return the services, by their names, whose sockets in this folder are in use."""
    locks = (lock for lock in folder.glob("*-*.lock") if _is_held(lock))
    return tuple(sorted({lock.stem.rpartition("-")[0] for lock in locks}))


def live_rendezvous(network: NetworkConfig) -> list[Path]:
    """Return the rendezvous of the doors at this host's loopback, where somebody listens. Raises ConfigError.

    Robots at other ports of this host are others, whatever they are called.
    """
    loopback = [address for address in addresses(network) if address.rpartition(":")[0] in _LOOPBACK]
    folders = [socket_folder(msgspec.structs.replace(network, rendezvous=address)) for address in loopback]
    meetings = [folder / "rendezvous" for folder in folders]
    return [meeting for meeting in meetings if _is_held(meeting.with_suffix(".lock"))]


def _is_held(lock: Path) -> bool:
    try:
        with contextlib.suppress(FileNotFoundError), lock.open("rb") as held:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except PermissionError:  # another service's user may open it alone
        return _is_answered(lock.with_suffix(""))
    return False


def _own_folder(environment: Mapping[str, str]) -> Path:
    """Return this user's folder, which nobody else may look into. Raises ConfigError."""
    given = environment.get("XDG_RUNTIME_DIR", "")
    folder = Path(given) / "giraff" if given and os.access(given, os.W_OK) else Path(f"/tmp/giraff-{os.getuid()}")  # noqa: S108
    with contextlib.suppress(OSError):
        folder.mkdir(mode=0o700, exist_ok=True)
    try:
        found = folder.lstat()
    except OSError as error:
        raise ConfigError(f"{folder}: {error.strerror}; set sockets in [network] to a folder of this user") from error
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o077:
        raise ConfigError(
            f"{folder}: others may put sockets there, and would be taken for this robot; "
            "remove it, or set sockets in [network] to a folder of this user alone"
        )
    return folder


def _remove_stale(lock: Path, after: float) -> None:
    """Remove a socket and its lock that no living process holds. Raises OSError."""
    if time.time() - lock.stat().st_mtime < after:
        return
    socket_path = lock.with_suffix("")
    with contextlib.ExitStack() as held:
        try:
            fcntl.flock(held.enter_context(lock.open("rb")), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except PermissionError:  # another service's user may open it alone; nobody could take its rendezvous over
            if _is_answered(socket_path):
                return
        socket_path.unlink(missing_ok=True)
        lock.unlink()


def _is_answered(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX) as caller:
        caller.setblocking(False)
        return caller.connect_ex(str(path)) not in {errno.ECONNREFUSED, errno.ENOENT}
