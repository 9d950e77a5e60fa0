"""How soon a process does what tests/functional asks of it: its end, and what is told of one that hangs."""

import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from giraff_cli.estop.client import engage
from giraff_cli.run.processes import ProcessGroup
from giraff_core.network import NetworkConfig
from giraff_health.ask import TIMEOUT
from giraff_node.network.session import close_session, open_session
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.ports import free_port
from tests.functional.cli.bases import ROBOT, base
from tests.functional.cli.test_children import STUBBORN, is_up, start
from tests.functional.health.answering import answering, check
from tests.functional.node.peers import Peers
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall


@pytest.fixture
def peers(tmp_path: Path) -> Iterator[Peers]:
    started = Peers(tmp_path)
    yield started
    started.close()


@pytest.mark.parametrize(
    ("role", "service", "number"),
    [
        ("talker", "base", signal.SIGTERM),
        ("talker", "base", signal.SIGINT),
        ("hanging", "guard", signal.SIGTERM),
    ],
)
def test_a_signal_ends_a_node_within_two_seconds(peers: Peers, role: str, service: str, number: signal.Signals) -> None:
    """Also one whose session hangs at its end."""
    process = peers.start(role)
    wait(lambda: peers.alive() == [service], 60.0)
    began = time.monotonic()
    with by_the_wall():
        process.send_signal(number)
        assert process.wait(timeout=60.0) == 0
        assert time.monotonic() - began < 2.0


@pytest.mark.parametrize("parts", [(), (b"{",)], ids=["mute", "stuck"])
def test_a_service_that_hangs_is_told_in_time(tmp_path: Path, parts: tuple[bytes, ...]) -> None:
    with answering(tmp_path, *parts, then_silent=True):
        began = time.monotonic()
        code, _ = check(tmp_path, "base")
        took = time.monotonic() - began
    assert code == 2
    assert took >= TIMEOUT
    with by_the_wall(time.monotonic_ns() - round(took * 1e9)):
        assert took < TIMEOUT + 3.0  # the rest is this machine's


def test_one_that_ignores_sigterm_is_killed_in_bounded_time(tmp_path: Path) -> None:
    (tmp_path / "stubborn.py").write_text(STUBBORN)
    children = ProcessGroup(tmp_path)
    start(children, tmp_path, "stubborn")
    wait(lambda: is_up(children, "stubborn"), 60.0)
    began = time.monotonic()
    with by_the_wall():
        assert children.stop_all(grace=0.3) == ["stubborn did not end within 0.3 s and was killed"]
        assert time.monotonic() - began < 3.0


def test_a_base_that_hangs_holds_back_no_confirmation_of_another() -> None:
    network = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
    staying = open_session(network, ROBOT, "door")
    connection = RobotConnection(ROBOT, open_session(network, ROBOT, "client"))
    release = threading.Event()

    def hang(_: Any) -> None:
        release.wait(300.0)

    with base(network, hang, instance="a") as hanging, base(network):
        while not hanging.asked:  # until both are met
            assert engage(connection, "me", "", 60.0).code == 0
        began = time.monotonic()
        with by_the_wall():
            assert engage(connection, "me", "", 60.0).code == 0
            assert time.monotonic() - began < 1.5, "held back until the slower one's time-out"
        release.set()
    assert connection.close()
    assert close_session(staying)
