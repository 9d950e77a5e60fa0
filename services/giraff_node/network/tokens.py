"""Liveliness tokens: the only place that reads the names of robots and services from the network.

Anybody on an open network can declare a token with any text in it. A name that cannot be part of a key belongs to no
robot of ours. It is left out and told, so that it cannot end a command.
"""

from collections.abc import Callable, Iterable
from typing import Final, NamedTuple

import zenoh

from giraff_node.network import consent
from giraff_node.network.replies import gather_replies
from giraff_schemas.services import PLAY, ROBOTS_OWN
from giraff_schemas.topics import alive_key, require_chunk

REPLY_WITHIN: Final = 0.5  # s in which whoever is there answers
_MOST_TOLD: Final = 5
"""Number of odd tokens that one process tells: a stranger must not fill the terminal or the log."""
_LONGEST_TOLD: Final = 100  # characters
_told: Final[set[str]] = set()


class Token(NamedTuple):
    """The names in the liveliness token of one process."""

    robot: str
    service: str
    instance: str


def read_token(key: str, tell: Callable[[str], object] = consent.print_notice) -> Token | None:
    """Return the names in a token. None: one of them cannot be part of a key; `tell` says so, once a key."""
    chunks = key.split("/")
    try:
        for chunk in chunks:
            require_chunk(chunk)
        _, robot, _, service, instance = chunks
    except ValueError:
        if key not in _told and len(_told) < _MOST_TOLD:
            _told.add(key)
            tell(f"somebody on the network has a name that no robot and no service can have, left out: {_short(key)}")
        return None
    return Token(robot, service, instance)


def find_tokens(session: zenoh.Session, key: str, within: float) -> list[Token]:
    """Ask for the tokens that match `key` (`alive_key`), for `within` s at most."""
    replies = gather_replies(lambda handler: session.liveliness().get(key, handler, timeout=within), within)
    found = (read_token(str(reply.ok.key_expr)) for reply in replies if reply.ok is not None)
    return [token for token in found if token is not None]


def list_robots(session: zenoh.Session) -> list[str]:
    """Return the names of the robots that are on the network now."""
    return robots_of(find_tokens(session, alive_key("*"), REPLY_WITHIN))


def robots_of(tokens: Iterable[Token]) -> list[str]:
    """Return the robots that these liveliness tokens tell of.

    A keyboard or a recorder that waits for a robot is no robot; one that is played is. Only where no robot has a
    service of its own there, whoever else uses its name stands for it.
    """
    services = [(token.robot, token.service) for token in tokens]
    own = {robot for robot, service in services if service in (*ROBOTS_OWN, PLAY.name)}
    return sorted(own or {robot for robot, _ in services})


def watch_tokens(
    session: zenoh.Session,
    robot: str,
    on_token: Callable[[Token, bool], object],
    tell: Callable[[str], object] = consent.print_notice,
    *,
    history: bool = True,
) -> "zenoh.Subscriber[None]":
    """Call `on_token` in Zenoh's thread with each token of `robot` ("*": of all) that comes (True) or goes (False).

    `history`: also with those that are there already. The caller keeps the subscriber: an unreferenced one ends.
    """

    def on_sample(received: zenoh.Sample) -> None:
        if (token := read_token(str(received.key_expr), tell)) is not None:
            on_token(token, received.kind == zenoh.SampleKind.PUT)

    return session.liveliness().declare_subscriber(alive_key(robot), on_sample, history=history)


def _short(key: str) -> str:
    return f"{key[:_LONGEST_TOLD]!a}{'...' if len(key) > _LONGEST_TOLD else ''}"
