"""A secured network on one loopback: a certificate for each host, and a session of each."""

from __future__ import annotations

import datetime as dt
import time
from pathlib import Path
from typing import Any, Final

import zenoh

from giraff_cli.keys import make_authority, make_bundle
from giraff_cli.watcher import free_port
from giraff_node.access import AccessConfig
from giraff_node.session import NetworkConfig, close_session, open_session
from giraff_schemas.topics import (
    ESTOP_ENGAGE,
    ESTOP_RESET,
    OPERATOR_CMD_VEL,
    PARAM_QUERIES,
    TICK,
    TOPICS,
    Query,
    key_of,
)
from tests.waiting import wait

ROBOT: Final = "sim-secured"
HOSTS: Final = ("robot", "laptop", "desk", "unnamed")
ACCESS: Final = AccessConfig(robot=("robot",), operators={"laptop": ("joystick",)}, viewers=("desk",))
MINE, ANOTHERS = OPERATOR_CMD_VEL.at("joystick"), OPERATOR_CMD_VEL.at("keyboard")


def authority(folder: Path) -> Path:
    """A folder of keys with a bundle for each host."""
    made, now = folder / "keys", dt.datetime.now(dt.UTC)
    make_authority(made, now)
    for host in HOSTS:
        make_bundle(made, host, ["192.0.2.1"], days=60, renew=False, moment=now)
    return made


class Network:
    """A session for each host, as its processes would open it, and one more of the robot's."""

    def __init__(self, keys: Path) -> None:
        rendezvous = f"127.0.0.1:{free_port()}"
        self.of = {
            host: NetworkConfig(mode="secured", rendezvous=rendezvous, keys=str(keys / host), access=ACCESS, local=True)
            for host in HOSTS
        }
        self.sessions = {host: open_session(self.of[host], ROBOT, visiting=host != "robot") for host in HOSTS}
        self.base = open_session(self.of["robot"], ROBOT, visiting=True)
        self.heard: list[tuple[str, str]] = []
        """(key, host) of what came to base."""
        self._declared: list[Any] = []
        for topic in TOPICS:
            self._declared.append(self.base.declare_subscriber(key_of(ROBOT, topic), self._on_sample))
        queries: list[Query[Any, Any]] = [ESTOP_ENGAGE, ESTOP_RESET, *(query.at("guard") for query in PARAM_QUERIES)]
        for query in queries:
            self._declared.append(self.base.declare_queryable(key_of(ROBOT, query), self._on_query))
        time.sleep(1.0)  # until all have met; that no link comes about has no event to wait for

    def _on_sample(self, sample: zenoh.Sample) -> None:
        self.heard.append((str(sample.key_expr).removeprefix(f"giraff/{ROBOT}/"), sample.payload.to_string()))

    def _on_query(self, query: zenoh.Query) -> None:
        with query:
            query.reply(query.key_expr, "done")

    def heard_of(self, host: str) -> set[str]:
        """Keys of what this host publishes on every key, and on all of them at once, that base hears."""
        self.heard.clear()
        for topic in (*(topic for topic in TOPICS if not topic.names), MINE, ANOTHERS):
            self.sessions[host].put(key_of(ROBOT, topic), host)
        for several in (
            f"giraff/{ROBOT}/cmd_vel/*",
            f"giraff/{ROBOT}/*",
            f"giraff/{ROBOT}/**",
            "giraff/*/cmd_vel",
            "**",
        ):
            self.sessions[host].put(several, host)
        self.sessions["robot"].put(key_of(ROBOT, TICK), "the last")
        wait(lambda: (TICK.key, "the last") in self.heard)
        time.sleep(0.2)  # another host's link may be slower than the robot's own
        return {key for key, maker in self.heard if maker == host}

    def close(self) -> None:
        for session in (*self.sessions.values(), self.base):
            close_session(session)
