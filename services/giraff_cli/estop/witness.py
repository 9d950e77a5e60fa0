"""Base's own word beside what is heard at a door, to which a stranger may have spoken in base's name."""

import contextlib
import threading
import time
from typing import Final

import zenoh

from giraff_node.network.query_client import EStopClient
from giraff_schemas.requests import EStopEngage
from giraff_tools.network.connection import RobotConnection

_WITHIN: Final = 0.5  # s in which a base of this host has told its word, or there is none
_TURN: Final = 0.01  # s


class Witness:
    """Asks the base of this very host once more, past the door.

    Over its Unix sockets comes no word of a stranger: access control passes `estop` from this host alone there.
    """

    def __init__(self, connection: RobotConnection, wish: EStopEngage) -> None:
        self.connection, self.wish = connection, wish
        self._until: float | None = None
        self._opening: list[threading.Thread] = []

    def has_heard(self, robot: str, instance: str) -> bool:
        """Return whether this base itself says that it has stopped. All calls together take 0.5 s at most."""
        if self._until is None:
            self._until, self._opening = time.monotonic() + _WITHIN, self.connection.open_own_host()
        asking: list[EStopClient] = []
        with contextlib.suppress(zenoh.ZError):  # that session has ended
            while (now := time.monotonic()) < self._until:
                is_opening = any(thread.is_alive() for thread in self._opening)
                asking += [EStopClient(each, robot, self.wish) for each in self.connection.own_host[len(asking) :]]
                if any((it := each.poll(now)) is not None and it.instance == instance for each in asking):
                    return True
                if not (asking or is_opening):
                    break
                time.sleep(_TURN)
        return False
