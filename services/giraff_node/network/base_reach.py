"""Find out whether a hand hears the robot's base, or only the door does.

Base listens at Unix sockets alone, so it has to dial a hand on another host. It cannot where that host lets nothing in:
a firewall, a network address translation, a container. The door is dialled by the hand, and so can always be asked.
"""

import contextlib
import threading
from typing import Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import NobodyError, close_session, open_clients, open_session
from giraff_node.network.tokens import Token, find_tokens, list_robots, watch_tokens
from giraff_schemas.services import BASE, ROBOTS_OWN
from giraff_schemas.topics import alive_key

_PATIENCE: Final = 1.0  # s from the first link; base dials within some ten ms
_ANSWERS_WITHIN: Final = 0.5  # s
_ALONE_AFTER: Final = 5.0  # s; a robot's services start within a few


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


class WrongRobotCheck:
    """Looks once, in a thread, whether a service hears nothing of its robot while other robots are there."""

    def __init__(self, session: zenoh.Session, network: NetworkConfig, robot: str, instance: str) -> None:
        self._session, self._network, self._robot, self._instance = session, network, robot, instance
        self._begins: float | None = None
        self._thread: threading.Thread | None = None
        self._others: tuple[str, ...] = ()

    def others(self, now: float) -> tuple[str, ...]:
        """Return the robots that are there in its place, once; `now`: monotonic, s. It never waits."""
        self._begins = now if self._begins is None else self._begins
        if self._thread is None and now >= self._begins + _ALONE_AFTER:
            self._thread = threading.Thread(target=self._check, name="robots", daemon=True)
            self._thread.start()
        found, self._others = self._others, ()
        return found

    def _check(self) -> None:
        found: set[str] = set()
        with contextlib.suppress(NobodyError, ConfigError, zenoh.ZError):  # also where the service ends meanwhile
            for token in find_tokens(self._session, alive_key(self._robot), _ANSWERS_WITHIN):
                if token.service in ROBOTS_OWN and token.instance != self._instance:
                    return
            # By name: one that is named is looked for beyond what answers on this host, which may be this very service.
            for _, session in open_clients(self._network, self._robot):
                found |= {*list_robots(session)}
                close_session(session)
        self._others = tuple(sorted(found - {self._robot}))
