"""A robot that says what a test makes it say: a session of its own, beside the real one."""

import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import Any

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.session import close_session, open_session
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Sample
from giraff_schemas.topics import Topic, alive_key, key_of
from giraff_tools.network.robot_graph import is_listened_to
from tests.support.waiting import wait

INSTANCE = "0123456789abcdef"


class Talker:
    """One process of a robot."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self.session = session
        self.robot = robot

    def say(self, topic: Topic[Any], sample: Sample, seqs: Collection[int], hz: float) -> None:
        """Publish these numbers, one in each period, from when somebody listens.

        A number that is left out takes its period all the same. Each is stamped with the time it is due, which is the
        same on a machine that is late.
        """
        publisher = self.session.declare_publisher(
            key_of(self.robot, topic),
            encoding=encoding_of(topic.schema),
            congestion_control=zenoh.CongestionControl.BLOCK,  # what is lost is what the test leaves out
        )
        wait(lambda: is_listened_to(publisher), 60.0, what="somebody who listens", every=0.01)
        began, began_ns, first = time.monotonic(), time.time_ns(), min(seqs)
        for seq in seqs:
            due = (seq - first) / hz
            time.sleep(max(0.0, began + due - time.monotonic()))
            publisher.put(encode(stamped(sample, seq, began_ns + round(due * 1e9), INSTANCE)))


@contextmanager
def talker(rendezvous: str, robot: str, service: str = "base") -> Iterator[Talker]:
    """With a token on the network, as long as the block lasts."""
    session = open_session(NetworkConfig(rendezvous=rendezvous, local=True), robot, "inside", visits=True)
    try:
        with session.liveliness().declare_token(alive_key(robot, service, INSTANCE)):
            yield Talker(session, robot)
    finally:
        close_session(session)
