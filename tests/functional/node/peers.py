"""Processes on one loopback, and what the test says to them."""

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import msgspec

from giraff_core.network import NetworkConfig
from giraff_node.network.session import open_session
from giraff_schemas.health import Health
from giraff_schemas.topics import Topic, alive_key, health_key, key_of
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.support.waiting import wait

ROBOT = "sim-node"
SERVICE = Path(__file__).with_name("service_under_test.py")


class Peers:
    """Processes of service_under_test and a session of the test's own, on one loopback."""

    def __init__(self, directory: Path) -> None:
        self.network = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
        self._stack = ExitStack()
        self.session = self._stack.enter_context(open_session(self.network, ROBOT, "inside", visits=True))
        self._directory = directory
        self._started: list[subprocess.Popen[bytes]] = []

    def start(self, role: str, **variables: str) -> subprocess.Popen[bytes]:
        given = {
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_ROBOT_NAME": ROBOT,
            "GIRAFF_NETWORK_LOCAL": "true",
            "GIRAFF_NETWORK_RENDEZVOUS": self.network.rendezvous,
        }
        with self.log(role).open("wb") as log, self.output(role).open("wb") as output:
            process = subprocess.Popen(
                [sys.executable, str(SERVICE), role], env=os.environ | given | variables, stdout=output, stderr=log
            )
        self._started.append(process)
        wait(lambda: f"robot {ROBOT}" in self.log(role).read_text(), 60.0)
        return process

    def log(self, role: str) -> Path:
        return self._directory / f"{role}.log"

    def output(self, role: str) -> Path:
        return self._directory / f"{role}.out"

    def alive(self) -> list[str]:
        replies = self.session.liveliness().get(alive_key(ROBOT), timeout=1.0)
        return sorted(str(reply.ok.key_expr).split("/")[-2] for reply in replies if reply.ok is not None)

    def health(self, service: str) -> Health:
        told: list[Health] = []

        def answers() -> bool:
            replies = self.session.get(health_key(ROBOT, service), timeout=2.0)
            said = [bytes(reply.ok.payload) for reply in replies if reply.ok is not None]
            told.extend(msgspec.msgpack.decode(payload, type=Health) for payload in said)
            return bool(told)

        wait(answers, 60.0, what=f"the health of {service}")
        return told[0]

    def close(self) -> None:
        for process in self._started:
            process.kill()
            process.wait()
        self._stack.close()

    def put_until(self, topic: Topic[Any], payload: bytes, holds: Callable[[], bool]) -> None:
        """Publish again and again: the first ones may come before the subscriber is known."""

        def put_and_look() -> bool:
            self.session.put(key_of(ROBOT, topic), payload)
            return holds()

        wait(put_and_look, 60.0)
