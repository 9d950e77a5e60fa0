"""What a service tells systemd, by the protocol of sd_notify(3): that it is ready, how it is, that its loop turns."""

import os
import socket
from collections.abc import Mapping
from typing import Final

from giraff_node.process.watchdog import watchdog_period
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_LONGEST: Final = 1000  # characters of a status


class Notifier:
    """Says nothing where nobody listens, which is where $NOTIFY_SOCKET is not set. Never waits, never raises."""

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        self.problem = NO_TROUBLE
        """Why systemd cannot be told anything, with the likely cause."""
        self._address = environment.get("NOTIFY_SOCKET", "")
        if self._address.startswith("@"):  # how an abstract socket's name is written
            self._address = "\0" + self._address[1:]
        # Made once: a door whose descriptors a flood has taken still has this one, and its watchdog is told.
        self._out = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK) if self._address else None
        watchdog = watchdog_period(environment)
        self._period = None if watchdog is None else watchdog / 2  # as sd_watchdog_enabled(3) advises
        self._next = 0.0
        self._ready = False
        self._status = ""

    def turn(self, now: float, status: str) -> None:
        """The loop turns. `now`: monotonic, s; `status`: one line for people."""
        if self._out is None:
            return
        news = []
        if not self._ready:
            news.append("READY=1")
        if status != self._status:
            news.append("STATUS=" + " ".join(status[:_LONGEST].split()))
        if self._period is not None and now >= self._next:
            news.append("WATCHDOG=1")
        if news and self._send(news):
            self._ready, self._status = True, status
            if self._period is not None:
                self._next = now + self._period

    def stopping(self) -> None:
        """The service ends now, and on purpose."""
        self._send(["STOPPING=1"])

    def __del__(self) -> None:
        if self._out is not None:
            self._out.close()

    def _send(self, news: list[str]) -> bool:
        """Whether the news was taken."""
        if self._out is None:
            return False
        try:
            self._out.sendto("\n".join(news).encode(errors="replace"), self._address)
        except BlockingIOError:  # the queue is full for now
            return False
        except (OSError, ValueError) as error:  # or a name that no socket can have
            shown = self._address.replace("\0", "@", 1)
            self.problem = Trouble(
                f"NOTIFY_SOCKET={shown}: {error}", "start this service by its unit, or unset the variable"
            )
            return False
        self.problem = NO_TROUBLE
        return True
