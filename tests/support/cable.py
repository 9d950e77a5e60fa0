"""The network between the operator's host and the robot's, as a TCP proxy that can do what networks do."""

import contextlib
import queue
import socket
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Final, Self

_CHUNK: Final = 65536
_LOOK: Final = 0.2  # s between looks at whether it ends


class Cable:
    """Passes bytes between whoever calls `port` and the loopback's port `target`, both ways, in their order.

    Cut, it keeps what was sent on both sides and passes all of it on once mended, as TCP does after a cable was
    pulled or a host was suspended: what arrives then is as old as the cut was long.
    """

    def __init__(self, port: int, target: int) -> None:
        self.port = port
        self.delay = 0.0
        """s that each byte takes."""
        self._target = target
        self._whole = threading.Event()
        self._whole.set()
        self._ending = threading.Event()
        self._sockets: list[socket.socket] = []
        self._listener = socket.create_server(("127.0.0.1", port))
        self._listener.settimeout(_LOOK)
        self._thread = threading.Thread(target=self._accept, daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._ending.set()
        self.mend()
        self._thread.join()
        self._listener.close()
        self.sever()

    def cut(self) -> None:
        """Hold everything back, new connections too."""
        self._whole.clear()

    def mend(self) -> None:
        """Pass on what was held back, and go on."""
        self._whole.set()

    def sever(self) -> None:
        """End each connection with what is still under way in it, as a router does that restarts."""
        for each in self._sockets:
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
        self._sockets.clear()

    def _accept(self) -> None:
        while not self._ending.is_set():
            with contextlib.suppress(TimeoutError):
                caller, _ = self._listener.accept()
                self._start(self._join, caller)

    def _start(self, what: Callable[..., None], *arguments: object) -> None:
        threading.Thread(target=what, args=arguments, daemon=True).start()

    def _join(self, caller: socket.socket) -> None:
        self._whole.wait()
        try:
            called = socket.create_connection(("127.0.0.1", self._target), timeout=1.0)
        except OSError:
            caller.close()  # nobody is there: refused, as without a cable in between
            return
        for each in (caller, called):
            each.settimeout(None)
            each.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._sockets.append(each)
        for source, sink in ((caller, called), (called, caller)):
            under_way: queue.Queue[tuple[float, bytes]] = queue.Queue()
            self._start(self._read, source, under_way)
            self._start(self._write, sink, under_way)

    def _read(self, source: socket.socket, under_way: queue.Queue[tuple[float, bytes]]) -> None:
        data = b"-"
        while data:
            try:
                data = source.recv(_CHUNK)
            except OSError:
                data = b""
            under_way.put((time.monotonic() + self.delay, data))

    def _write(self, sink: socket.socket, under_way: queue.Queue[tuple[float, bytes]]) -> None:
        while True:
            due, data = under_way.get()
            while (wait := due - time.monotonic()) > 0.0:
                time.sleep(wait)
            self._whole.wait()
            with contextlib.suppress(OSError):
                if not data:
                    sink.shutdown(socket.SHUT_RDWR)
                    sink.close()
                    return
                sink.sendall(data)
