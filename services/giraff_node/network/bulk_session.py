"""The Zenoh session of samples that are large: a client of the robot's door, beside the session of all others.

In the session of ticks and states, a picture of 40 kB would wait before them in the kernel's buffers, at any priority.
This session has links of its own, and so has each listener behind the door.
"""

import threading
import time
from collections.abc import Callable
from typing import Final, Generic

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import NobodyError, close_session, open_session
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.topics import SampleT, Topic, key_of
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_AGAIN: Final = 2.0  # s until a door that did not answer is tried again


class BulkSession:
    """It is opened by a thread, which waits for the door."""

    def __init__(self, network: NetworkConfig, robot: str, tell: Callable[[Trouble], None]) -> None:
        """`tell`: takes why nothing can be sent, and NO_TROUBLE once it can; in that thread."""
        self._network, self._robot, self._tell = network, robot, tell
        self.session: zenoh.Session | None = None
        """None: it is not open yet."""
        self._closed = threading.Event()
        # No daemon: Zenoh aborts a process that ends while a session is being opened.
        self._thread = threading.Thread(target=self._open, name="bulk")
        self._thread.start()

    def close(self) -> None:
        """Wait for its end, for some seconds at most."""
        self._closed.set()
        self._thread.join()
        if self.session is not None:
            close_session(self.session)

    def _open(self) -> None:
        while not self._closed.is_set():
            try:
                self.session = open_session(self._network, self._robot, "client")
            except (NobodyError, ConfigError, zenoh.ZError) as error:
                self._tell(Trouble(f"no door of the robot answers: {error}", "start giraff_door on the robot"))
                self._closed.wait(_AGAIN)
                continue
            self._tell(NO_TROUBLE)
            return


class BulkPublisher(Generic[SampleT]):
    """Stamps and publishes the samples of one topic. What cannot be sent at once is dropped, and counted by `seq`."""

    def __init__(self, session: BulkSession, robot: str, topic: Topic[SampleT], instance: str) -> None:
        """`instance`: of the maker."""
        self._session, self._key, self._topic, self._instance = session, key_of(robot, topic), topic, instance
        self._publisher: zenoh.Publisher | None = None
        self._seq = 0

    def put(self, sample: SampleT) -> None:
        if self._publisher is None and (session := self._session.session) is not None:
            self._publisher = session.declare_publisher(
                self._key,
                encoding=encoding_of(self._topic.schema),
                congestion_control=zenoh.CongestionControl.DROP,
                priority=zenoh.Priority.BACKGROUND,
            )
        if self._publisher is not None:
            self._publisher.put(encode(stamped(sample, self._seq, time.time_ns(), self._instance)))
        self._seq += 1
