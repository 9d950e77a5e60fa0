"""A short visit to the network: find the robot, ask, tell, leave."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from typing import Final

import zenoh

from giraff_cli.robots import NoRobotError, find_way, only_robot
from giraff_cli.watcher import Watcher
from giraff_node.session import open_session

UNUSABLE: Final = 2


def visit(robot: str | None, connect: Sequence[str], patience: float, act: Callable[[Watcher], int]) -> int:
    """The exit code of `act`, or UNUSABLE where there is no robot to act on. `patience`: s, to look for one."""
    try:
        way = find_way(robot, connect)
        if way.warning:
            complain(f"not everything of robot file and environment counts: {way.warning}")
        session = open_session(way.network, visiting=True)
    except NoRobotError as error:
        return complain(str(error))
    except zenoh.ZError as error:
        return complain(f"no Zenoh session: {error}; check the table [network] of the robot file, and --connect")
    watcher = Watcher(way.robot, session)
    try:
        watcher.robot = way.robot or only_robot(session, patience)
        code = act(watcher)
    except NoRobotError as error:
        code = complain(str(error))
    sys.stdout.flush()
    if not watcher.close():  # Zenoh would hold the process, and nothing is left to do
        os._exit(code)
    return code


def complain(text: str) -> int:
    """Tell what is wrong; UNUSABLE."""
    print(f"giraff: {text}", file=sys.stderr, flush=True)
    return UNUSABLE
