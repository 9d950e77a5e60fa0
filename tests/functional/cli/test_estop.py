"""`giraff estop` with real sessions, against a base made of Python. Each case of it: tests/unit/cli/test_estop.py."""

import threading
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from giraff_cli.estop.client import engage, reset, status
from giraff_core.estop.request import BY_WORD
from giraff_core.network import NetworkConfig
from giraff_node.network.discovery import RobotMonitor
from giraff_node.network.session import Role, close_session, open_session
from giraff_node.network.tokens import list_robots
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import alive_key
from giraff_schemas.trouble import Trouble
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.ports import free_port
from tests.functional.cli.bases import DONE, EPOCH, ROBOT, base
from tests.support.waiting import wait


@pytest.fixture
def network() -> Iterator[NetworkConfig]:
    """Of a process that stays, and at whose rendezvous the others meet."""
    made = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
    staying = open_session(made, ROBOT, "door")
    yield made
    assert close_session(staying)


@pytest.fixture
def connection(network: NetworkConfig) -> Iterator[RobotConnection]:
    made = RobotConnection(ROBOT, open_session(network, ROBOT, "client"))
    yield made
    assert made.close()


def test_a_stop_and_a_reset_are_told_once_base_confirms_them(
    network: NetworkConfig, connection: RobotConnection
) -> None:
    def answer(request: Any) -> EStopAnswer:
        return DONE if isinstance(request, EStopEngage) else EStopAnswer(done=True, engaged=False, id=7)

    with base(network, answer) as robot:
        assert engage(connection, "me", "a cat", 60.0).code == 0
        assert engage(connection, "me", "a cat", 60.0, off=True).code == 1, "this base tells of no off"
        assert status(connection, 60.0).text == f"{ROBOT}: ENGAGED, latch 7, by ann@desk: smoke"
        code, text, *_ = reset(connection, "me", 60.0)
    assert code == 0
    assert text.startswith(f"cleared latch 7 of {ROBOT}")
    assert robot.asked[0][0] == EStopEngage(by="me", reason=Trouble("a cat"))
    assert EStopEngage(by="me", reason=Trouble("a cat"), off=True) in [request for request, _ in robot.asked]
    request, _ = robot.asked[-1]
    assert isinstance(request, EStopReset)
    assert (request.id, request.tick is not None and request.tick.epoch) == (7, EPOCH)


@pytest.mark.parametrize(("role", "whose"), [("inside", ""), ("client", f", {BY_WORD}")])
def test_on_an_open_network_only_a_base_of_this_very_host_proves_a_stop(
    role: Role, whose: str, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stranger, the door's client, answers and says base's own `estop`, while the true base hangs."""
    if not whose:
        monkeypatch.setattr("giraff_cli.estop.witness._WITHIN", 60.0)
    folder = str(tmp_path_factory.mktemp("own"))
    network = NetworkConfig(mode="fixed", rendezvous=f"127.0.0.1:{free_port()}", sockets=folder)
    with ExitStack() as left:
        for each in ("door", "inside"):  # the first answers at the rendezvous, the second at the sockets
            left.callback(close_session, open_session(network, ROBOT, each))
        left.enter_context(base(network, role=role))
        connection = RobotConnection(ROBOT, open_session(network, ROBOT, "client"), network=network)
        left.callback(connection.close)
        result = engage(connection, "me", "a cat", 60.0)
    assert (result.code, result.text.partition(";")[0]) == (0, f"{ROBOT}: STOPPED{whose}, latch 7")


def test_a_base_that_hangs_does_not_hide_the_answer_of_another(
    network: NetworkConfig, connection: RobotConnection
) -> None:
    release = threading.Event()

    def hang(_: Any) -> None:
        release.wait(300.0)

    with base(network, hang, instance="a") as hanging, base(network):
        while not hanging.asked:  # until both are met
            assert engage(connection, "me", "", 60.0).code == 0
        assert engage(connection, "me", "", 60.0).code == 0
        release.set()


def test_more_robots_than_zenoh_keeps_replies_hold_nobody(network: NetworkConfig, connection: RobotConnection) -> None:
    stranger = open_session(network, "*", "client")
    tokens = [stranger.liveliness().declare_token(alive_key(f"r{number}", "base", "x")) for number in range(300)]
    meeting = RobotMonitor(connection.session)
    wait(lambda: len(meeting.names) == len(tokens), 60.0)
    looking = threading.Thread(target=lambda: list_robots(connection.session), daemon=True)
    looking.start()
    looking.join(60.0)
    assert not looking.is_alive()
    wait(lambda: len(list_robots(connection.session)) == len(tokens), 60.0)
    assert close_session(stranger)
