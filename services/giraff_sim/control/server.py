"""The Unix socket that requests of the control protocol arrive on, a JSON object a line."""

import contextlib
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Final

import msgspec

from giraff_node.process.unix_socket import listen_at
from giraff_sim.control import messages

_LONGEST_LINE: Final = 65536


class ControlServer:
    """The socket and its clients. Nothing here waits: a client that does not read its replies is dropped."""

    def __init__(self, path: Path, answer: Callable[[bytes], messages.Reply]) -> None:
        self._path = path
        self._answer = answer
        self._clients: dict[int, tuple[socket.socket, bytearray]] = {}
        try:
            self._listener = listen_at(path)
        except OSError as error:
            raise ValueError(f"{path}: cannot be a control socket: {error}") from error

    @property
    def listener(self) -> int:
        """Descriptor that is readable when a client calls."""
        return self._listener.fileno()

    def accept(self) -> int | None:
        """A new client's descriptor."""
        with contextlib.suppress(BlockingIOError):
            client, _ = self._listener.accept()
            client.setblocking(False)
            self._clients[client.fileno()] = client, bytearray()
            return client.fileno()
        return None

    def serve(self, descriptor: int) -> bool:
        """Answer what a client has sent. False when it has gone."""
        client, received = self._clients[descriptor]
        try:
            data = client.recv(_LONGEST_LINE)
        except BlockingIOError:
            return True
        except OSError:
            data = b""
        try:
            received += data
            *lines, rest = bytes(received).split(b"\n")
            received[:] = rest
            for line in lines:
                client.sendall(msgspec.json.encode(self._answer(line)) + b"\n")
        except OSError:  # gone, or deaf with a full socket
            data = b""
        if data and len(received) < _LONGEST_LINE:
            return True
        client.close()
        del self._clients[descriptor]
        return False

    def close(self) -> None:
        """End all connections and take the path away."""
        for client, _ in self._clients.values():
            client.close()
        self._clients.clear()
        self._listener.close()
        self._path.unlink(missing_ok=True)
