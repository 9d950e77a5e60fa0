"""Listens to one robot on the network: its samples, and which of its services are there."""

from __future__ import annotations

import contextlib
import random
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import zenoh

from giraff_cli.telemetry import Telemetry
from giraff_node import robot_now_ns
from giraff_node.session import NetworkConfig, open_session
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.messages import Sample
from giraff_schemas.topics import ROOT, TOPICS, Topic, alive_key, key_of

_CLOSE_TIMEOUT: Final = 1.0  # s; a session's close can hang
_OWN_PORTS: Final = (20_000, 32_000)  # below Linux's range for outgoing connections, 32768 to 60999
_ASK_AGAIN: Final = 0.1  # s

Report = Callable[[Telemetry], None]
"""Tells the telemetry of one thing that was heard."""


class Watcher:
    """A session of its own. What Zenoh's threads hear waits in a queue, so that telemetry has one thread."""

    def __init__(self, robot: str, network: NetworkConfig) -> None:
        """Join the network. Raises `zenoh.ZError`."""
        self._robot = robot
        self._session = open_session(network)
        self._heard: deque[Report] = deque()
        self._declared: list[Any] = []  # a subscriber that nobody references ends
        self._complaints: dict[str, str] = {}

    def namesake(self, patience: float) -> str | None:
        """The liveliness token of a base that already runs under this robot's name; looks for `patience` s."""
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline:
            for reply in self._session.liveliness().get(alive_key(self._robot, "base"), timeout=patience):
                if reply.ok is not None:
                    return str(reply.ok.key_expr)
            time.sleep(_ASK_AGAIN)
        return None

    def listen(self) -> None:
        """Hear every topic of the robot, and its services come and go."""
        for topic in TOPICS:
            self._declared.append(self._session.declare_subscriber(key_of(self._robot, topic), self._hearer(topic)))
        self._declared.append(
            self._session.liveliness().declare_subscriber(alive_key(self._robot), self._on_token, history=True)
        )

    def pass_on(self, telemetry: Telemetry) -> None:
        """Tell `telemetry` what was heard since the last call."""
        with contextlib.suppress(IndexError):  # Zenoh's threads fill it: emptiness cannot be asked first
            while True:
                self._heard.popleft()(telemetry)

    @property
    def complaints(self) -> list[str]:
        """What could not be decoded, the newest of each key."""
        return list(self._complaints.values())

    def close(self) -> bool:
        """Leave the network; False when Zenoh does not come back from it."""
        closing = threading.Thread(target=self._session.close, daemon=True)
        closing.start()
        closing.join(_CLOSE_TIMEOUT)
        return not closing.is_alive()

    def _hearer(self, topic: Topic[Any]) -> Callable[[zenoh.Sample], None]:
        def on_sample(received: zenoh.Sample) -> None:
            now_ns = robot_now_ns()
            key = str(received.key_expr)
            try:
                sample: Sample = decode(topic, key, bytes(received.payload), str(received.encoding))
            except DecodeError as error:
                self._complaints[key] = str(error)
                return
            below = key.removeprefix(f"{ROOT}/{self._robot}/")
            self._heard.append(lambda telemetry: telemetry.hear(topic, below, sample, now_ns))

        return on_sample

    def _on_token(self, received: zenoh.Sample) -> None:
        *_, service, instance = str(received.key_expr).split("/")
        present = received.kind == zenoh.SampleKind.PUT
        self._heard.append(lambda telemetry: telemetry.announce(service, instance, present=present))


def free_port() -> int:
    """A port of the loopback that nobody listens on, and that no outgoing connection is given by the kernel.

    One of the kernel's would be free now and taken in a moment; a peer that calls it before anybody listens could
    even be given the port for its own end, and be connected to itself.
    """
    while True:
        port = random.randrange(*_OWN_PORTS)
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port


def claim(robot: str) -> socket.socket | None:
    """Hold a robot's name among this host's runs, as long as the socket lives; None when another run holds it.

    The liveliness of a namesake shows only where there is a network to show it on.
    """
    held = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        held.bind(f"\0giraff run {robot}")  # an abstract name: it goes with the process, and leaves no file
    except OSError:
        held.close()
        return None
    return held
