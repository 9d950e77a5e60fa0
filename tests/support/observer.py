"""A listener beside the robot: the newest sample of each key, and a hand on the network for what tests put there."""

from collections.abc import Callable, Mapping
from typing import Any

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import load
from giraff_node.network.session import close_session, open_session
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.topics import Query, SampleT, Topic, key_of


class Observer:
    """A peer of the robot's network that no service knows of, and its door."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._robot = environment["GIRAFF_ROBOT_NAME"]
        network = load("network", NetworkConfig, environment)
        self.session = open_session(network, self._robot, "inside", visits=True)
        self.door = open_session(network, self._robot, "door", visits=True)
        self._newest: dict[str, Any] = {}
        self._declared: list[Any] = []  # a subscriber that nobody references ends

    def follow(self, topic: Topic[Any]) -> None:
        """Keep the newest sample of a topic."""
        self.listen(topic, lambda sample: self._newest.__setitem__(topic.key, sample))

    def newest(self, topic: Topic[SampleT]) -> SampleT | None:
        """Of a topic that is followed."""
        sample: SampleT | None = self._newest.get(topic.key)
        return sample

    def listen(self, topic: Topic[SampleT], callback: Callable[[SampleT], None]) -> None:
        """Call `callback` with each sound sample, in Zenoh's thread."""

        def on_sample(received: zenoh.Sample) -> None:
            try:
                sample = decode(topic, str(received.key_expr), bytes(received.payload), str(received.encoding))
            except DecodeError:
                return  # a test's own doing
            callback(sample)

        self.listen_raw(topic, on_sample)

    def listen_raw(self, topic: Topic[Any], callback: Callable[[zenoh.Sample], None]) -> None:
        """Call `callback` with each sample as it comes over the network."""
        self._declared.append(self.session.declare_subscriber(self.key(topic), callback))

    def key(self, topic: Topic[Any] | Query[Any, Any]) -> str:
        return key_of(self._robot, topic)

    def close(self) -> None:
        self._declared.clear()
        close_session(self.door)
        close_session(self.session)
