"""Samples that make no turn due wait in a ring of a real session."""

from pathlib import Path

from giraff_core.network import NetworkConfig
from giraff_node.network.session import close_session, open_session
from giraff_node.network.subscription import PolledInbox, Reader
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Tick
from giraff_schemas.topics import TICK, key_of
from giraff_tools.network.ports import free_port
from tests.support.waiting import wait


def test_rubbish_between_two_turns_pushes_out_no_sample_before_it(tmp_path: Path) -> None:
    network = NetworkConfig(local=True, sockets=str(tmp_path), rendezvous=f"127.0.0.1:{free_port()}")
    session = open_session(network, "here", "apart")
    try:
        key = key_of("here", TICK)
        inbox: PolledInbox[Tick] = PolledInbox(200, Reader(TICK, key, lambda *_: None))
        inbox.subscriber = session.declare_subscriber(key, inbox.ring)
        for number in range(3):
            tick = stamped(Tick(epoch=1, robot_ns=number), number, 0, "0123456789abcdef")
            session.put(key, encode(tick), encoding=encoding_of(Tick))
        for _ in range(250):
            session.put(key, b"rubbish")
        taken: list[int] = []

        def have_come() -> bool:
            taken.extend(tick.robot_ns for tick in inbox.pop_all())
            return len(taken) >= 3

        wait(have_come, 20.0)
        assert taken == [0, 1, 2]
    finally:
        close_session(session)
