"""Somebody to notify, in systemd's place."""

import socket


class FakeManager:
    """The other end of $NOTIFY_SOCKET."""

    def __init__(self, address: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(address.replace("@", "\0", 1))
        self._socket.setblocking(False)
        self.environment = {"NOTIFY_SOCKET": address}

    def heard(self) -> list[str]:
        """The assignments since the last call."""
        told = []
        while True:
            try:
                told += self._socket.recv(65536).decode().split("\n")
            except BlockingIOError:
                return told

    def await_next(self) -> list[str]:
        """What is said next, within a minute."""
        self._socket.settimeout(60.0)
        try:
            return self._socket.recv(65536).decode().split("\n")
        finally:
            self._socket.setblocking(False)

    def close(self) -> None:
        self._socket.close()
