"""The Zenoh session of a process: table `[network]` of the robot file.

Each departure from Zenoh's defaults answers a fault that was seen: see docs/network.md.
"""

from __future__ import annotations

import json
import threading
from typing import Any, Final

import msgspec
import zenoh

_CLOSE_TIMEOUT: Final = 1.0  # s


class NetworkConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How this process meets the others."""

    session_file: str = ""
    """A Zenoh JSON5 file; when given, it alone counts."""
    rendezvous: str = "127.0.0.1:7447"
    """Where the processes of one host find each other, with or without a network. Any of them may own it."""
    connect: tuple[str, ...] = ()
    """More endpoints to connect to, like "tcp/192.168.1.20:7447": for networks without multicast."""
    local: bool = False
    """Keep off the network: loopback only."""


def session_config(network: NetworkConfig, *, visiting: bool = False) -> dict[str, Any]:
    """The Zenoh configuration of a peer, as nested dictionaries.

    `visiting`: it is gone in a moment, and leaves the rendezvous to those who stay. A session that waits for the
    rendezvous to become free does not come back from its close, either.
    """
    own_port = "tcp/127.0.0.1:0" if network.local else "tcp/0.0.0.0:0"
    retried_listen = "#exit_on_failure=false;retry_period_init_ms=500;retry_period_max_ms=1000"
    return {
        "mode": "peer",
        "listen": {
            "endpoints": [own_port] if visiting else [f"tcp/{network.rendezvous}{retried_listen}", own_port],
            "timeout_ms": -1,
            "exit_on_failure": False,
        },
        "connect": {
            "endpoints": [f"tcp/{network.rendezvous}", *(() if network.local else network.connect)],
            "timeout_ms": -1,
            "exit_on_failure": False,
            "retry": {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 1.5},
        },
        "scouting": {
            "delay": 200,
            "multicast": {"enabled": not network.local},
            "gossip": {"autoconnect_strategy": {"peer": {"to_router": "always", "to_peer": "greater-zid"}}},
        },
        "timestamping": {"enabled": True},
        "queries_default_timeout": 2000,
        "transport": {
            "unicast": {"open_timeout": 2000, "accept_timeout": 2000},
            "link": {
                "tx": {"lease": 1500, "keep_alive": 4, "queue": {"size": {"real_time": 16, "data_high": 16}}},
            },
            "shared_memory": {"enabled": False},
        },
    }


def open_session(network: NetworkConfig, *, visiting: bool = False) -> zenoh.Session:
    """Join the network, or visit it. Raises `zenoh.ZError`."""
    if network.session_file:
        return zenoh.open(zenoh.Config.from_file(network.session_file))
    return zenoh.open(zenoh.Config.from_json5(json.dumps(session_config(network, visiting=visiting))))


def close_session(session: zenoh.Session) -> bool:
    """Leave the network; False when Zenoh does not come back from it: its close can hang, the process must not."""
    closing = threading.Thread(target=session.close, daemon=True)
    closing.start()
    closing.join(_CLOSE_TIMEOUT)
    return not closing.is_alive()
