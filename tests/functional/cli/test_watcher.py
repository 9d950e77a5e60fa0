"""What is on the network reaches the telemetry; a namesake is found."""

import json
import secrets
import time
from collections.abc import Iterator

import pytest
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.session import open_session, session_config
from giraff_schemas.codec import encode, stamped
from giraff_schemas.messages import Tick
from giraff_schemas.topics import TICK, alive_key, key_of
from giraff_telemetry.collector import Telemetry
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.ports import claim, free_port
from tests.support.waiting import wait

ROBOT = f"sim-{secrets.token_hex(4)}"


@pytest.fixture
def network() -> NetworkConfig:
    return NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)


@pytest.fixture
def connection(network: NetworkConfig) -> Iterator[RobotConnection]:
    opened = RobotConnection(ROBOT, open_session(network, ROBOT, "door"))
    yield opened
    assert opened.close()


@pytest.fixture
def other(connection: RobotConnection, network: NetworkConfig) -> Iterator[zenoh.Session]:  # noqa: ARG001
    """Another process that has found its way to the rendezvous."""
    config = zenoh.Config()
    config.insert_json5("listen/endpoints", json.dumps(["tcp/127.0.0.1:0"]))
    config.insert_json5("connect/endpoints", json.dumps([f"tcp/{network.rendezvous}"]))
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as session:
        yield session


def test_samples_and_services_are_told(connection: RobotConnection, other: zenoh.Session) -> None:
    telemetry = Telemetry()
    connection.subscribe_all()

    def heard() -> bool:
        other.put(key_of(ROBOT, TICK), encode(stamped(Tick(epoch=1, robot_ns=2), 0, 0, "one")))
        connection.dispatch(telemetry)
        return telemetry.latest(TICK, time.monotonic_ns()) is not None

    def alive() -> list[str]:
        connection.dispatch(telemetry)
        return sorted(telemetry.alive)

    wait(heard, 60.0, what="the tick")
    with other.liveliness().declare_token(alive_key(ROBOT, "base", "one")):
        wait(lambda: alive() == ["base"], 60.0, what="the token")
    wait(lambda: not alive(), 60.0, what="its end")
    assert connection.decode_errors == []


def test_what_cannot_be_decoded_is_named(connection: RobotConnection, other: zenoh.Session) -> None:
    connection.subscribe_all()

    def named() -> bool:
        other.put(key_of(ROBOT, TICK), b"\x93")
        return bool(connection.decode_errors)

    wait(named, 60.0, what="the complaint")
    assert connection.decode_errors[0].startswith(key_of(ROBOT, TICK))


def test_a_namesake_is_found_and_others_are_not(connection: RobotConnection, other: zenoh.Session) -> None:
    tokens = other.liveliness()
    with (
        tokens.declare_token(alive_key("somebody-else", "base", "1")),
        tokens.declare_token(alive_key(ROBOT, "viewer", "2")),
    ):
        assert connection.find_duplicate(0.3) is None
        with tokens.declare_token(alive_key(ROBOT, "base", "3")):
            assert connection.find_duplicate(60.0) == alive_key(ROBOT, "base", "3")


def test_a_visitor_leaves_the_rendezvous_to_those_who_stay(network: NetworkConfig) -> None:
    assert network.rendezvous in str(session_config(network, ROBOT, "door")["listen"])
    assert network.rendezvous not in str(session_config(network, ROBOT, "client")["listen"])
    assert network.rendezvous in str(session_config(network, ROBOT, "client")["connect"])


def test_a_name_is_held_by_one_run_of_a_host() -> None:
    held = claim(ROBOT)
    assert held is not None
    assert claim(ROBOT) is None
    held.close()
    again = claim(ROBOT)
    assert again is not None
    again.close()
