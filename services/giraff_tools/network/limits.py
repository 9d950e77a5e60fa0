"""What an operator must know of a robot before it may ask for anything: base tells it."""

import sys
import time
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tokens import list_robots
from giraff_schemas.checks import converted
from giraff_schemas.params import ParamAnswer, ParamDescribe
from giraff_schemas.services import BASE
from giraff_schemas.topics import PARAM_DESCRIBE
from giraff_tools.network.connection import RobotConnection

_PATIENCE: Final = 5.0  # s
_SAYS_SO: Final = 0.5  # s after which a person is told what is waited for
_TURN: Final = 0.01  # s
_SHARED: Final = "robot."


def ask_base(connection: RobotConnection) -> QueryClient[ParamDescribe, ParamAnswer]:
    """Return a question for all parameters of base, the table [robot] among them."""
    return QueryClient(connection.session, connection.robot, PARAM_DESCRIBE.at(BASE.name), ParamDescribe())


def ask_limits(connection: RobotConnection, verb: str) -> RobotConfig:
    """The robot's geometry and limits, as base goes by them. Raises NoRobotError. `verb`: that asks."""
    robot = connection.robot
    asking = ask_base(connection)
    began = time.monotonic()
    says_at = began + _SAYS_SO
    while (now := time.monotonic()) < began + _PATIENCE:
        if (answer := asking.poll(now)) is not None:
            return limits_of(answer, robot)
        if now >= says_at:
            waits = f"giraff {verb}: waits for base of {robot} to tell the robot's limits"
            print(waits, file=sys.stderr, flush=True)
            says_at = began + _PATIENCE
        time.sleep(_TURN)
    there = list_robots(connection.session)
    if robot not in there:
        raise NoRobotError(not_found_text(robot, there))
    why = f" ({asking.fault})" if asking.fault else ""
    raise NoRobotError(
        f"base of {robot} has not told the robot's limits within {_PATIENCE:g} s{why}; check that giraff_base runs; "
        "on a secured network [network.access] says who may ask"
    )


def limits_of(answer: ParamAnswer, robot: str) -> RobotConfig:
    """What base's answer has of the table [robot]. Raises NoRobotError where it cannot be one."""
    told = {param.name.removeprefix(_SHARED): param.value for param in answer.params if param.name.startswith(_SHARED)}
    try:
        return converted(told | {"name": robot}, RobotConfig)
    except ValueError as error:
        raise NoRobotError(
            f"base of {robot} at {answer.host} tells limits that cannot be: {error}; "
            "check its robot file, and that both machines have the same version of giraff"
        ) from error
