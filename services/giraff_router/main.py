"""The router's process: a Zenoh session in mode "router", and a log of who comes and goes."""

from __future__ import annotations

import json
import os
import secrets
import signal
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from types import FrameType
from typing import Any

import zenoh

from giraff_node.config import ConfigError, load
from giraff_node.health import Condition
from giraff_node.health_socket import HealthSocket
from giraff_node.key_bundle import ExpiryWatch
from giraff_node.logs import service_logger
from giraff_node.session import certificates, close_session, settings
from giraff_node.systemd import Notifier
from giraff_node.watch import Selectable, Waker, Watch
from giraff_router.config import RouterConfig
from giraff_router.policy import Visitors, gateway, rules

_LOOK = 0.5  # s between looks at who is there


def router_config(router: RouterConfig) -> dict[str, Any]:
    """The Zenoh configuration, as nested dictionaries. Raises ConfigError."""
    config = settings("peer", router.mode, "router")
    protocol = "tls" if router.mode == "secured" else "tcp"
    config["listen"]["endpoints"] = [f"{protocol}/{address}" for address in router.listen]
    config["connect"]["endpoints"] = []  # all dial in: where they are, nothing may be able to
    config["gateway"] = gateway(router.sites)
    if router.mode == "secured":
        config["transport"]["link"]["tls"] |= certificates(Path(router.keys))
        config["access_control"] |= rules(router.robots)
    return config


class Process:
    """Stops at SIGTERM and SIGINT; tells systemd and healthchecks how it is."""

    def __init__(self) -> None:
        self.log = service_logger("router")
        self._stopping = False
        self._waker = Waker()
        for number in (signal.SIGTERM, signal.SIGINT):  # before the session: opening it takes a moment
            signal.signal(number, self._on_signal)
        signal.set_wakeup_fd(self._waker.for_signals, warn_on_full_buffer=False)
        try:
            router = load("router", RouterConfig)
            self._session = zenoh.open(zenoh.Config.from_json5(json.dumps(router_config(router))))
        except ConfigError as error:
            self.log.error("%s", error)
            sys.exit(2)
        except zenoh.ZError as error:
            self.log.error("no router: %s; is another program at that address, or is it not this host's?", error)
            sys.exit(2)
        self._visitors = Visitors(router.robots)
        self._keys = ExpiryWatch(Path(router.keys)) if router.mode == "secured" else None
        self._condition = Condition("router", secrets.token_hex(8), self.log)
        self._health_socket = HealthSocket("router")
        self._notifier = Notifier()
        self.log.info(
            "%s, listening at %s, between %s, for %s, pid %d",
            router.mode,
            ", ".join(router.listen),
            ", ".join(router.sites),
            ", ".join(router.robots) or "any robot and anybody",
            os.getpid(),
        )

    def run(self) -> None:
        with Watch(self._waker, self._health_socket) as watch:
            asked: set[Selectable] = set()
            while not self._stopping:
                now = time.monotonic()
                self._look()
                self._health_socket.keep_open(now)
                if self._health_socket in asked:
                    self._health_socket.answer(self._condition.health)
                self._notifier.turn(now, self._condition.summary)
                self._condition.set_fault("health socket", self._health_socket.fault)
                self._condition.set_notice("systemd", self._notifier.problem)
                asked = watch.wait(_LOOK)
                self._waker.drain()

    def end(self) -> None:
        self._notifier.stopping()
        self._health_socket.close()
        signal.set_wakeup_fd(-1)
        closed = close_session(self._session)
        self.log.info("ended")
        if not closed:
            sys.stderr.flush()
            os._exit(0)

    def _look(self) -> None:
        links = [(link.auth_identifier or "somebody", link.dst) for link in self._session.info.links()]
        for news in self._visitors.look(links):
            self.log.info("%s", news)
        self._condition.set_notice("strangers", self._visitors.strangers)
        if self._keys is not None:
            self._condition.set_notice("keys", self._keys.warning(datetime.now(UTC)))

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self._stopping = True  # the wake-up descriptor has already been written to


def main() -> None:
    process = Process()
    try:
        process.run()
    finally:
        process.end()
