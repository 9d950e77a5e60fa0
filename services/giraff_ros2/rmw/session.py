"""The session of ROS: a peer of the router that ROS processes look for, or that router itself.

ROS processes look for a router at one address, which is localhost:7447 unless somebody says otherwise, and meet
through it. On a host with a robot's door, Giraff itself listens there: then this is a router at another port.
"""

import contextlib
import socket
import time
from typing import Any, Final, NamedTuple

import msgspec
import zenoh

from giraff_core.network import host_and_port
from giraff_node.network.session import close_session
from giraff_ros2.config import endpoint
from giraff_schemas.topics import CAMERA_PICTURES, ROOT

OTHER_PORT: Final = 7460
"""Port of this router where a process that is no router listens at the one that was asked for."""
_ANSWERS_WITHIN: Final = 1.0  # s; TCP, and then a router's greeting
_LOOK: Final = 0.02  # s
_OF_THIS_HOST: Final = ("127.0.0.1", "localhost", "::1", "0.0.0.0", "::")  # noqa: S104


_WITHOUT_GIRAFF: Final = {
    "enabled": True,
    "default_permission": "allow",
    "rules": [
        {
            "id": "no robot",
            "permission": "deny",
            "flows": ["ingress", "egress"],
            "messages": [
                *("put", "delete", "query", "reply", "declare_subscriber", "declare_queryable"),
                *("liveliness_token", "liveliness_query", "declare_liveliness_subscriber"),
            ],
            "key_exprs": [f"{ROOT}/**", *(f"{ROOT}/*/{topic.key}" for topic in CAMERA_PICTURES)],
        }
    ],
    "subjects": [{"id": "all"}],
    "policies": [{"rules": ["no robot"], "subjects": ["all"]}],
}
"""Processes of Giraff on this host look for a door where this router listens. It passes on nothing of theirs."""


class RosSession(NamedTuple):
    """An open session."""

    session: zenoh.Session
    port: int
    """Port of the router."""
    is_router: bool
    """This session is the router itself."""
    host: str
    """Host of the router, as it was given."""

    @property
    def is_reached(self) -> bool:
        """Tell whether the router is there."""
        return self.is_router or bool(self.session.info.routers_zid())


class NoRosError(Exception):
    """There is no way to ROS. The message says why, and what to do."""


def open_ros(address: str) -> RosSession:
    """Meet ROS processes at the router of this address, or become it. Raises NoRosError."""
    host, port = host_and_port(address)
    if not _is_own(host):
        return RosSession(zenoh.open(_config("peer", host, port)), port, is_router=False, host=host)
    why = []
    for each in dict.fromkeys((port, OTHER_PORT)):
        try:
            if not _is_answered(host, each):
                return RosSession(zenoh.open(_config("router", host, each)), each, is_router=True, host=host)
            if (found := _peer(host, each)) is not None:
                return found
            why.append(f"a process that is no Zenoh router listens at {host}:{each}")
        except zenoh.ZError as error:
            why.append(f"no Zenoh router can be opened at {host}:{each}: {error}")
    told = ", and ".join(why)
    raise NoRosError(f"{told}; give the address of another port, like 127.0.0.1:7470, as `router` of [ros2]")


def _peer(host: str, port: int) -> RosSession | None:
    """Return the session of a peer of a router; None: no router answers."""
    found = RosSession(zenoh.open(_config("peer", host, port)), port, is_router=False, host=host)
    until = time.monotonic() + _ANSWERS_WITHIN
    while not found.is_reached:
        if time.monotonic() >= until:
            close_session(found.session)
            return None
        time.sleep(_LOOK)
    return found


def _config(mode: str, host: str, port: int) -> zenoh.Config:
    """Return a session's configuration as rmw_zenoh's own files have it, at one address."""
    at = endpoint(host, port)
    is_router = mode == "router"
    config: dict[str, Any] = {
        "mode": mode,
        "connect": {"endpoints": [] if is_router else [at]},
        "listen": {"endpoints": [at] if is_router else ["tcp/127.0.0.1:0"]},
        "scouting": {"multicast": {"enabled": False}},
        # Latched topics need times.
        "timestamping": {"enabled": True},
        "transport": {"shared_memory": {"enabled": False}},
    }
    if is_router:
        config["access_control"] = _WITHOUT_GIRAFF
    return zenoh.Config.from_json5(msgspec.json.encode(config).decode())


def _is_answered(host: str, port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection((host, port), _ANSWERS_WITHIN):
        return True
    return False


def _is_own(host: str) -> bool:
    """Tell whether this host has the address: a port of it can be bound."""
    if host in _OF_THIS_HOST:
        return True
    with contextlib.suppress(OSError):
        family, kind, _, _, where = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as probe:
            probe.bind(where)
            return True
    return False
