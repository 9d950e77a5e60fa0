"""Whose word a confirmed stop is, as `giraff estop engage` says it."""

from typing import Any, cast

import pytest

from giraff_cli.estop.client import Result, engage, engage_all
from giraff_core.access import AccessConfig
from giraff_core.estop.request import BY_WORD
from giraff_core.network import NetworkConfig
from giraff_schemas.topics import alive_key
from giraff_tools.network.connection import RobotConnection
from tests.unit.cli.test_estop import ROBOT, WISH, Network, network

__all__ = ["network"]

OPEN = f"STOPPED, {BY_WORD}, latch 7"
SECURED = NetworkConfig(mode="secured", access=AccessConfig(robot=("robot",)))


@pytest.mark.parametrize(
    ("at", "is_here", "says"),
    [
        pytest.param(SECURED, False, "STOPPED, latch 7", id="secured"),
        pytest.param(NetworkConfig(local=True), False, "STOPPED, latch 7", id="loopback"),
        pytest.param(NetworkConfig(), True, "STOPPED, latch 7", id="own-host"),
        pytest.param(NetworkConfig(), False, OPEN, id="lan"),
        pytest.param(NetworkConfig(mode="fixed"), False, OPEN, id="fixed"),
        pytest.param(NetworkConfig(local=True, session_file="s.json5"), False, OPEN, id="session-file"),
    ],
)
def test_a_stop_is_bases_own_word_only_where_no_stranger_can_say_it(
    network: Network, monkeypatch: pytest.MonkeyPatch, at: NetworkConfig, is_here: bool, says: str
) -> None:
    """`is_here`: base says it over the sockets of this host, too."""
    monkeypatch.setattr("giraff_cli.estop.witness.time", network.clock)
    # All robots are stopped by threads, which share this clock: the pauses of one pass the time of another.
    monkeypatch.setattr("giraff_cli.estop.witness._WITHIN", 1e6)
    monkeypatch.setattr(RobotConnection, "open_own_host", lambda *_: [])
    network.connection.own_host += [cast(Any, network.session)] * is_here
    network.connection.network = at
    told: list[Result] = []
    with network.base(), network.session.declare_token(alive_key(ROBOT, "base", "b")):
        told.append(engage(network.connection, "me", "a cat", 10.0))
        assert engage_all(network.connection, WISH, 10.0, (), told.append) == 0
    assert [(result.code, result.text.partition(";")[0]) for result in told] == [(0, f"{ROBOT}: {says}")] * 2
