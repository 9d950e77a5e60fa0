"""Asks whether somebody already tells where a robot is on the map."""

from typing import Final

from giraff_node.network.consent import NoRobotError
from giraff_node.network.tokens import find_tokens
from giraff_schemas.services import LOCALIZATION
from giraff_schemas.topics import alive_key
from giraff_tools.network.connection import RobotConnection

_REPLY_WITHIN: Final = 1.0  # s, for liveliness tokens


def is_there(connection: RobotConnection) -> bool:
    """Return whether localization of this robot runs on the network."""
    key = alive_key(connection.robot, LOCALIZATION.name)
    return bool(find_tokens(connection.session, key, _REPLY_WITHIN))


def require_none(connection: RobotConnection, remedy: str) -> None:
    """Raise NoRobotError where one runs already: two would tell two places."""
    if is_there(connection):
        raise NoRobotError(f"localization of {connection.robot} runs on the network already; {remedy}")
