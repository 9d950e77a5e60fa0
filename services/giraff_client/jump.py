"""Telling odometry where the robot is, from a script."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

import zenoh

from giraff_client.errors import RobotError, SilentError
from giraff_node.network.query_client import QueryClient
from giraff_schemas.messages import Odometry
from giraff_schemas.requests import OdomAnswer
from giraff_schemas.topics import Query, RequestT

_LOOK: Final = 0.01  # s


def jump(
    session: zenoh.Session,
    robot: str,
    query: Query[RequestT, OdomAnswer],
    request: RequestT,
    patience: float,
    newest: Callable[[], tuple[Odometry | None, float]],
) -> None:
    """Ask until odometry has done it, and until the newest that is heard of it is from after.

    `newest`: what is heard of odometry, and when it was, s of the monotonic clock. Raises SilentError, RobotError.
    """
    asked = time.monotonic()
    asking = QueryClient(session, robot, query, request)
    answer = asking.wait(asked + patience)
    if answer is None:
        raise SilentError(
            f"{asking.fault or f'nobody answers {query.key}'}; check that giraff_odometry runs; "
            "on a secured network [network.access] says who may ask"
        )
    if not answer.done:
        raise RobotError(f"odometry refuses: {answer.reason}")
    until = time.monotonic() + patience
    while time.monotonic() < until:
        sample, heard = newest()
        if sample is not None and heard > asked and sample.jumps >= answer.jumps:
            return
        time.sleep(_LOOK)
    raise SilentError("odometry has done it, and odom is not heard since; check that giraff_base runs")
