"""Find out whether a hand hears the robot's base, or only the door does.

Base listens at Unix sockets alone, so it has to dial a hand on another host. It cannot where that host lets nothing in:
a firewall, a network address translation, a container. The door is dialled by the hand, and so can always be asked.
"""

from __future__ import annotations

import threading
from typing import Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import NobodyError, close_session, open_session
from giraff_node.network.tokens import Token, find_tokens, watch_tokens
from giraff_schemas.services import BASE
from giraff_schemas.topics import alive_key

_PATIENCE: Final = 1.0  # s from the first link; base dials within some ten ms
_ANSWERS_WITHIN: Final = 0.5  # s


class BaseReach:
    """Watches one session of a hand, until base has been heard once: then the way is there."""

    def __init__(self, session: zenoh.Session, network: NetworkConfig, robot: str) -> None:
        self._session, self._network, self._robot = session, network, robot
        self._heard = self._door_hears = False
        self._next: float | None = None
        self._asking: threading.Thread | None = None
        self._subscriber = watch_tokens(session, robot, self._on_token)

    def is_deaf(self, now: float) -> bool:
        """Whether the door hears base and this session never did; `now`: monotonic, s. It never waits."""
        if self._heard:
            return False
        if self._next is None and next(iter(self._session.info.peers_zid()), None) is not None:
            self._next = now + _PATIENCE
        if self._next is not None and now >= self._next and (self._asking is None or not self._asking.is_alive()):
            self._next = now + _PATIENCE
            self._asking = threading.Thread(target=self._ask, name="door", daemon=True)
            self._asking.start()
        return self._door_hears and not self._heard

    def _on_token(self, token: Token, present: bool) -> None:
        self._heard |= present and token.service == BASE.name

    def _ask(self) -> None:
        try:
            session = open_session(self._network, self._robot, "client")
        except (NobodyError, ConfigError, zenoh.ZError):  # the link that is there leads to no door
            return
        self._door_hears = bool(find_tokens(session, alive_key(self._robot, BASE.name), _ANSWERS_WITHIN))
        close_session(session)
