"""A Unix socket that can be asked as soon as it can be seen."""

import contextlib
import os
import socket
from pathlib import Path


def listen_at(path: Path, rights: int | None = None) -> socket.socket:
    """A listener in place of whatever socket is at `path`. It never waits. Raises OSError, and then leaves nothing.

    `rights`: file mode from the first moment at which anybody can connect; None: what the process's umask leaves.

    Between bind and listen a client is refused: it is made beside the path, and moved there once it listens.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f"{path.name}.new")
    fresh.unlink(missing_ok=True)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        listener.setblocking(False)
        listener.bind(os.fspath(fresh))
        if rights is not None:
            fresh.chmod(rights)
        listener.listen()
        fresh.replace(path)
    except OSError:
        listener.close()
        with contextlib.suppress(OSError):
            fresh.unlink()
        raise
    return listener
