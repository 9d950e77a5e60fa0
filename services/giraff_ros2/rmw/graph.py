"""Publishers and subscribers on a ROS network, as far as this node cares. No I/O."""

import threading
from collections.abc import Collection, Mapping
from typing import Final

from giraff_ros2.port import RosPublisher
from giraff_ros2.rmw.names import Entity, dds_type, entity_of, gid_of
from giraff_ros2.topics import RosTopic
from giraff_schemas.text import printable
from giraff_schemas.topics import LONGEST_CHUNK
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_MOST: Final = 500
"""Tokens that are remembered: on an open network anybody may declare one."""


class Graph:
    """Feed it each token that comes or goes, from any thread."""

    def __init__(self, own: str, topics: Mapping[RosTopic, tuple[str, str]], published: Collection[str] = ()) -> None:
        """`own`: Zenoh id of this process. `topics`: full name and type hash of each topic that is listened to.

        `published`: full names of those that this node publishes.
        """
        self._own = own
        self._topics = {(name, dds_type(topic.type), hash_): topic for topic, (name, hash_) in topics.items()}
        self._names = {"MP": {name for name, _, _ in self._topics}, "MS": set(published)}
        self._lock = threading.Lock()
        self._entities: dict[str, Entity] = {}
        self.publishers: tuple[RosPublisher, ...] = ()
        """Others' publishers on the topics that are listened to, with the very type."""
        self.wanted: frozenset[str] = frozenset()
        """Full names of the topics that others subscribe to."""
        self.trouble = NO_TROUBLE
        """Which publisher is not heard, because its type is another."""

    def on_token(self, token: str, *, is_there: bool) -> None:
        """Take that a token is there, or is gone."""
        entity = entity_of(token)
        if entity is None or entity.session == self._own or entity.name not in self._names.get(entity.kind, ()):
            return
        with self._lock:
            if not is_there:
                self._entities.pop(token, None)
            elif len(self._entities) < _MOST:
                self._entities[token] = entity
            self._sum_up()

    def _sum_up(self) -> None:
        publishers, self.trouble = [], NO_TROUBLE
        for token, entity in self._entities.items():
            topic = self._topics.get((entity.name, entity.type, entity.type_hash))
            if topic is not None and entity.kind == "MP":
                publishers.append(RosPublisher(gid_of(token), _readable(entity.full_node), entity.session, topic))
            elif entity.kind == "MP":
                self.trouble = _unheard(entity)
        if len(self._entities) >= _MOST:
            self.trouble = Trouble(f"more than {_MOST} publishers and subscribers are there, and not all are known")
        self.publishers = tuple(publishers)
        self.wanted = frozenset(entity.name for entity in self._entities.values() if entity.kind == "MS")


def _readable(name: str) -> str:
    """Return a name of somebody's as people may be shown it."""
    return printable(name[:LONGEST_CHUNK])


def _unheard(entity: Entity) -> Trouble:
    node, name, kind = (_readable(each) for each in (entity.full_node, entity.name, entity.type))
    return Trouble(
        f"{node} publishes {name} as {kind} of another type or hash, and is not heard",
        "check its type, and that `distribution` of [ros2] is that of its ROS 2",
    )
