"""The sentry's process beside a secured robot: whoever tries what is not theirs is named in its log."""

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
import tomlkit

from giraff_node.network.session import close_session
from giraff_schemas.topics import CMD_VEL, ODOM, key_of
from giraff_sim.board import ROOT
from tests.functional.node.secured import ANOTHERS, MINE, Network, open_marked
from tests.support.secured_hosts import ACCESS, ROBOT, authority
from tests.support.waiting import wait


class Sentry:
    """The process and what it has logged."""

    def __init__(self, directory: Path) -> None:
        self.network = Network(authority(directory))
        self.own = self.network.of["robot"]
        document = tomlkit.parse((ROOT / "deploy" / "robot.toml").read_text())
        document["network"] = msgspec.to_builtins(self.own) | {"access": msgspec.to_builtins(ACCESS)}
        document["robot"]["name"] = ROBOT
        document["sentry"] = {"again": 0.5}
        (directory / "robot.toml").write_text(tomlkit.dumps(document))
        self._log = directory / "log"
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "giraff_node", "sentry"],
                env=os.environ | {"GIRAFF_CONFIG": str(directory / "robot.toml")},
                stdout=subprocess.DEVNULL,
                stderr=log,
            )
        self.wait_for(f"robot {ROBOT}")

    def messages(self) -> list[str]:
        return [json.loads(line)["message"] for line in self._log.read_text().splitlines()]

    def wait_for(self, text: str) -> None:
        wait(
            lambda: any(text in message for message in self.messages()),
            60.0,
            what=lambda: f"{text!r} is not in {self.messages()}",
        )

    def close(self) -> None:
        self._process.terminate()
        assert self._process.wait(60.0) == 0
        self.network.close()


@pytest.fixture(scope="module")
def sentry(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Sentry]:
    made = Sentry(tmp_path_factory.mktemp("sentry"))
    yield made
    made.close()


@pytest.mark.parametrize(
    ("host", "topic"), [("desk", CMD_VEL), ("laptop", CMD_VEL), ("laptop", ANOTHERS), ("desk", MINE)]
)
def test_who_commands_without_being_allowed_to_is_named(sentry: Sentry, host: str, topic: object) -> None:
    key = key_of(ROBOT, topic)  # type: ignore[arg-type]
    session = sentry.network.sessions[host]
    with session.declare_publisher(key) as publisher:

        def is_named() -> bool:
            session.put(key, "drive")
            publisher.put("drive")
            return any(told.startswith(f"refused {host}") and f"put on {key};" in told for told in sentry.messages())

        wait(is_named, 60.0, what=sentry.messages, every=0.1)


def test_a_caller_who_is_not_of_this_network_is_told(sentry: Sentry) -> None:
    for locator in _locators(sentry):
        with socket.create_connection(("127.0.0.1", int(locator.rpartition(":")[2]))) as stranger:
            stranger.sendall(b"GET / HTTP/1.0\r\n\r\n")
            stranger.recv(100)
    sentry.wait_for("refused a caller that is not of this network")


def _locators(sentry: Sentry) -> list[str]:
    """Where the sentry's own process listens."""
    listening = subprocess.run(["ss", "-Hltnp"], check=True, capture_output=True, text=True).stdout.splitlines()
    return [line.split()[3] for line in listening if f"pid={sentry._process.pid}," in line]


def test_what_is_allowed_is_not_told(sentry: Sentry) -> None:
    """Nor is it told by the time that what came after it, and is not allowed, has been."""
    network = sentry.network
    before = len(sentry.messages())
    joined = open_marked(network.of["laptop"], "outside")

    def said(host: str, key: str) -> bool:
        return any(told.startswith(f"refused {host}") and f" {key};" in told for told in sentry.messages()[before:])

    with (
        joined.declare_subscriber(key_of(ROBOT, ODOM), lambda _: None),
        joined.declare_publisher(key_of(ROBOT, MINE)) as publisher,
    ):

        def is_told() -> bool:
            publisher.put("drive")
            network.sessions["laptop"].put(key_of(ROBOT, MINE), "drive")
            network.sessions["robot"].put(key_of(ROBOT, CMD_VEL), "drive")
            network.base.put(key_of(ROBOT, ODOM), "where")
            for session in (joined, network.sessions["laptop"]):
                session.put(key_of(ROBOT, ANOTHERS), "drive")
            return said("laptop", key_of(ROBOT, ANOTHERS))

        wait(is_told, 60.0, what=sentry.messages, every=0.1)
    close_session(joined)
    refused = [told for told in sentry.messages()[before:] if told.startswith(("refused laptop", "refused robot"))]
    assert [told for told in refused if f" {key_of(ROBOT, ANOTHERS)};" not in told] == []
