"""A secured network on one loopback: a certificate for each host, and a session of each.

That something does not come is shown by what is sent after it over the same link, and does: a mark. Beside the rules
that are tried, each host may tell marks and hear them.
"""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.session import Role, close_session, session_config
from giraff_schemas.topics import (
    OPERATOR_CMD_VEL,
    PARAM_QUERIES,
    QUERIES,
    TOPICS,
    Query,
    key_of,
)
from giraff_tools.network.ports import free_port
from tests.support.secured_hosts import ACCESS, HOSTS, ROBOT
from tests.support.waiting import wait

_PATIENCE: Final = 60.0
"""s, of one who asks: longer than any mark needs."""
MINE, ANOTHERS = OPERATOR_CMD_VEL.at("joystick"), OPERATOR_CMD_VEL.at("keyboard")


def direct(callback: Callable[[Any], object]) -> "zenoh.handlers.Callback[Any]":
    """Called by the link itself, so that what came first was also taken first, on whatever keys it came."""
    return zenoh.handlers.Callback(callback, indirect=False)


def open_marked(network: NetworkConfig, role: Role) -> zenoh.Session:
    """As a process of this host would open it, with marks."""
    config = session_config(network, ROBOT, role)
    marks = {
        "id": "marks",
        "flows": ["ingress", "egress"],
        "messages": ["put", "declare_subscriber"],
        "permission": "allow",
        "key_exprs": ["marks/*"],
    }
    config["access_control"]["rules"].append(marks)
    config["access_control"]["subjects"].append({"id": "everybody", "cert_common_names": [*HOSTS]})
    config["access_control"]["policies"].append({"rules": ["marks"], "subjects": ["everybody"]})
    return zenoh.open(zenoh.Config.from_json5(json.dumps(config)))


class Network:
    """A session for each host, as its processes would open it, and base and the door of the robot's."""

    def __init__(self, keys: Path) -> None:
        rendezvous = f"127.0.0.1:{free_port()}"
        self.of = {
            host: NetworkConfig(mode="secured", rendezvous=rendezvous, keys=str(keys / host), access=ACCESS, local=True)
            for host in HOSTS
        }
        self.door = open_marked(self.of["robot"], "door")
        self.sessions = {host: open_marked(self.of[host], "inside" if host == "robot" else "outside") for host in HOSTS}
        self.base = open_marked(self.of["robot"], "inside")
        self.heard: list[tuple[str, str]] = []
        """(key, host) of what came to base."""
        self._marks = count()
        self._marked: dict[str, set[str]] = {host: set() for host in HOSTS}
        self._declared: list[Any] = [self.base.declare_subscriber("marks/base", direct(self._on_sample))]
        for host, session in self.sessions.items():
            take = direct(partial(self._on_mark, host))
            self._declared.append(session.declare_subscriber(f"marks/{host}", take))
        for topic in TOPICS:
            self._declared.append(self.base.declare_subscriber(key_of(ROBOT, topic), direct(self._on_sample)))
        queries: list[Query[Any, Any]] = [*QUERIES, *(query.at("guard") for query in PARAM_QUERIES)]
        for query in queries:
            self._declared.append(self.base.declare_queryable(key_of(ROBOT, query), direct(self._on_query)))
        for host in HOSTS:
            self.base_has_all_of(host)
            self.has_all_of_base(host)

    def base_has_all_of(self, host: str) -> None:
        """Wait until base has taken whatever this host has sent it."""
        mark = f"{host} {next(self._marks)}"

        def has_come() -> bool:
            self.sessions[host].put("marks/base", mark)
            return ("marks/base", mark) in self.heard

        wait(has_come, 60.0)

    def has_all_of_base(self, host: str) -> None:
        """Wait until this host has taken whatever base has sent it."""
        mark = f"base {next(self._marks)}"

        def has_come() -> bool:
            self.base.put(f"marks/{host}", mark)
            return mark in self._marked[host]

        wait(has_come, 60.0)

    @contextmanager
    def hearing(self, host: str, key: str) -> Iterator[list[str]]:
        """What this host hears on a key, of what base says in the block; base knows that it listens."""
        heard: list[str] = []
        take = direct(lambda sample: heard.append(sample.payload.to_string()))
        with self.sessions[host].declare_subscriber(key, take):
            self.base_has_all_of(host)
            yield heard
            self.has_all_of_base(host)

    def answers_of_base(self, host: str, key: str) -> list[bool]:
        """Of each reply to this host whether it is an answer."""
        replies: list[bool] = []
        self.has_all_of_base(host)  # and so knows who answers
        self.sessions[host].get(key, direct(lambda reply: replies.append(reply.ok is not None)), timeout=_PATIENCE)
        self.base_has_all_of(host)
        self.has_all_of_base(host)
        return replies

    def answers_to_base(self, host: str, key: str) -> list[bool]:
        """The same, of what base asks this host."""
        replies: list[bool] = []
        self.base_has_all_of(host)
        self.base.get(key, direct(lambda reply: replies.append(reply.ok is not None)), timeout=_PATIENCE)
        self.has_all_of_base(host)
        self.base_has_all_of(host)
        return replies

    def _on_sample(self, sample: zenoh.Sample) -> None:
        self.heard.append((str(sample.key_expr).removeprefix(f"giraff/{ROBOT}/"), sample.payload.to_string()))

    def _on_mark(self, host: str, sample: zenoh.Sample) -> None:
        self._marked[host].add(sample.payload.to_string())

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
        self.base_has_all_of(host)
        return {key for key, maker in self.heard if maker == host}

    def close(self) -> None:
        for session in (*self.sessions.values(), self.base, self.door):
            close_session(session)
