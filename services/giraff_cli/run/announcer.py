"""What a run itself says on the network: where the simulated robot truly is, for people who look at it."""

import logging
import secrets
import time
from collections.abc import Callable
from typing import Final

import msgspec
import zenoh

from giraff_core.timer import Timer
from giraff_maps.room_file import Point
from giraff_node.node import Publisher
from giraff_node.process.health import HealthState
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.health import Health
from giraff_schemas.messages import TruePose
from giraff_schemas.services import RUN
from giraff_schemas.topics import TRUE_POSE, alive_key, health_key

Walls = tuple[tuple[Point, ...], ...]
"""Lines of the room, m in `odom`."""

_ROOM_HZ: Final = 0.5
_MOST_POINTS: Final = 3000
"""Points of a room that is said, 60 kB: `giraff record` takes no sample above 64 KiB."""

_log: Final = logging.getLogger(__name__)


class Announcer:
    """Tells of itself as a service does, so that whoever looks knows who says this. It ends with its session."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self._room_due = Timer(_ROOM_HZ)
        instance = secrets.token_hex(8)
        self._condition = HealthState(RUN.name, instance, _log)
        self._condition.publishes.append(TRUE_POSE.key)
        self._publisher = Publisher(session, robot, TRUE_POSE, instance)
        self._queryable = session.declare_queryable(health_key(robot, RUN.name), self._on_health_query)
        self._token = session.liveliness().declare_token(alive_key(robot, RUN.name, instance))

    def publish(self, pose: TruePose | None, find_walls: Callable[[], Walls]) -> None:
        """Say where the robot is, and now and then what stands around it. None: that is not known yet."""
        if pose is None:
            return
        if self._room_due.due(time.monotonic()) and sum(map(len, walls := find_walls())) <= _MOST_POINTS:
            pose = msgspec.structs.replace(pose, walls=walls)
        self._publisher.put(pose)

    def _on_health_query(self, query: zenoh.Query) -> None:
        query.reply(query.key_expr, encode(self._condition.health()), encoding=encoding_of(Health))
