"""The service's way to ROS: `giraff_ros2.rmw` on a network, and a double in tests. No I/O here."""

from collections.abc import Iterable
from typing import Any, Final, NamedTuple, Protocol

from giraff_core.io import Selectable
from giraff_ros2.answers import Answers
from giraff_ros2.topics import RosTopic
from giraff_schemas.trouble import Trouble

OTHER_LIBRARY: Final = "whose library does not give ids as rmw_zenoh_cpp does"
USE_RMW_ZENOH: Final = "drive by a program on rmw_zenoh_cpp"


class RosPublisher(NamedTuple):
    """Somebody's publisher of a topic that this service listens to, as its liveliness token tells."""

    gid: bytes
    """Its id, 16 bytes, which each of its samples has in the attachment."""
    node: str
    """Full name of its node, like `/teleop_twist_keyboard`."""
    process: str
    """Zenoh id of its session."""
    topic: RosTopic


class Received(NamedTuple):
    """A message of somebody's publisher."""

    topic: RosTopic
    message: Any
    """An object of rosbags' class for the type; each number in it may be NaN."""
    gid: bytes
    """Its publisher's, 16 bytes. Samples and tokens come in any order: the publisher may not be known yet."""
    sent_ns: int
    """Wall clock of the sender's host when it was sent, ns since 1970."""
    at: float
    """s, monotonic: when it came."""


class Refused(NamedTuple):
    """A sample that is no message: torn, without an attachment, or of another type."""

    topic: RosTopic
    trouble: Trouble


class Call(Protocol):
    """A call of a `std_srvs/srv/Trigger`, waiting for its answer."""

    def answer(self, success: bool, message: str) -> None: ...


class RosPort(Selectable, Protocol):
    """One node on a ROS network. No call waits. What has come makes a turn due."""

    def publish(self, topic: RosTopic, message: Any) -> None:
        """Send a message of rosbags' class for the topic's type. A latched one is kept for who comes later."""
        ...

    def pop_all(self) -> Iterable[Received | Refused]:
        """Return what has come on the topics of `SUBSCRIBED` since the last call, in its order."""
        ...

    def calls(self) -> Iterable[Call]:
        """The calls of `ESTOP` that have come since the last call of this."""
        ...

    def publishers(self) -> Iterable[RosPublisher]:
        """Return who publishes on the topics of `SUBSCRIBED`, by tokens. A frozen process keeps its own a minute."""
        ...

    def is_wanted(self, topic: RosTopic) -> bool:
        """Tell whether a ROS process subscribes to a topic that this node publishes."""
        ...

    def answers(self, process: str) -> Answers:
        """Return what a process was asked and has answered until now.

        A process that publishes on a topic of `SUBSCRIBED` is asked all the time. One that is frozen answers nothing.
        """
        ...

    def wall_ns(self) -> int:
        """Wall clock of this host, ns since 1970: for stamps of what is said of now, never for a decision."""
        ...

    def trouble(self) -> Trouble:
        """Return what is wrong with the way to ROS, and with what it publishes; NO_TROUBLE: nothing is known."""
        ...
