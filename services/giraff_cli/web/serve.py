"""`giraff web`: finds the robot, asks it for its limits, and is giraff_web in this terminal."""

from collections.abc import Sequence
from typing import Final

from giraff_node import Node
from giraff_node.config.settings import Settings
from giraff_node.network.hand import open_hand
from giraff_schemas.services import WEB
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_limits
from giraff_tools.network.ports import port_or_any
from giraff_tools.terminal import addresses
from giraff_web.config import WebConfig
from giraff_web.main import run_web

_DONE: Final = 0


def serve(robot: str | None, connect: Sequence[str], port: int | None, *, as_json: bool) -> int:
    """Serve until Ctrl-C; return the exit code.

    `port`: None: the usual one, or any where somebody has that. `as_json`: print the addresses as an object a line.
    """

    def act(connection: RobotConnection) -> int:
        limits = ask_limits(connection, "web")
        usual = WebConfig()
        config = WebConfig(port=port_or_any(usual.port) if port is None else port)
        return _serve(connection, Settings(config, limits, connection.network), as_json=as_json)

    # A page stays for days. Its stop must not be the simulation's when the robot has come.
    return run_with_robot(robot, connect, act, moves=True, stands_in=False)


def _serve(connection: RobotConnection, settings: Settings[WebConfig], *, as_json: bool) -> int:
    # The services' runtime from here on, with its signals: whatever ends it, the robot is told first.
    session = open_hand(connection.network, connection.robot, connection.session)
    with Node(WEB.name, settings, session=session) as node:
        tell = addresses.tell_programs if as_json else addresses.print_addresses
        run_web(node, lambda told: tell(addresses.with_loopback(told)))
    return _DONE
