"""The session of a hand: a peer, to which the robot's services link one by one, so that it outlives the door."""

import time
from typing import Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network import consent
from giraff_node.network.session import close_session, open_session
from giraff_node.network.tokens import find_tokens
from giraff_schemas.services import BASE
from giraff_schemas.topics import alive_key

_WITHIN: Final = 1.0  # s in which base dials a hand that can be dialled
_LOOK: Final = 0.05  # s
_ANSWERS_WITHIN: Final = 0.3  # s


def open_hand(network: NetworkConfig, robot: str, door: zenoh.Session) -> zenoh.Session:
    """Open the session to drive by, and close that of the door, unless base is heard through the door alone.

    Base dials hands on other hosts. One that cannot be dialled goes on through the door, which is told to the person.
    """
    if network.session_file or network.client:
        return door
    hand = open_session(network, robot, "outside")
    until = time.monotonic() + _WITHIN
    while not _is_heard(hand, robot):
        if time.monotonic() >= until and _is_heard(door, robot):
            close_session(hand)
            consent.print_notice(
                "this host cannot be dialled (a firewall?): all goes through the robot's door, "
                "and is silent for 3 s where that is started again"
            )
            return door
        if time.monotonic() >= until:
            break
        time.sleep(_LOOK)
    close_session(door)
    return hand


def _is_heard(session: zenoh.Session, robot: str) -> bool:
    return bool(find_tokens(session, alive_key(robot, BASE.name), _ANSWERS_WITHIN))
