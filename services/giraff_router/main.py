"""The router's process: a Zenoh session in mode "router", and a log of who comes and goes."""

import json
import os
import sys
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import zenoh

from giraff_core.timer import Timer
from giraff_node.config.robot_file import ConfigError, load
from giraff_node.network.key_bundle import ExpiryWatch
from giraff_node.network.session import certificates, settings
from giraff_node.network.tcp_options import set_tcp_options
from giraff_node.process.lifecycle import Process
from giraff_router.config import RouterConfig
from giraff_router.policy import Visitors, gateway, rules

_LOOK_HZ = 2.0  # at who is there
# A place whose connection ends takes all its links with it at one moment, and a dead link's close blocks a receiving
# thread for up to 10 s: with 16 threads, 60 links that went froze all others as long.
_RUNTIME = "(rx: (worker_threads: 64))"


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


def main() -> None:
    os.environ["ZENOH_RUNTIME"] = _RUNTIME  # read once, when the first session opens
    process = Process("router")  # before the session: opening it takes a moment
    try:
        router = load("router", RouterConfig)
        session = zenoh.open(zenoh.Config.from_json5(json.dumps(router_config(router))))
    except ConfigError as error:
        process.log.error("%s", error)
        sys.exit(2)
    except zenoh.ZError as error:
        process.log.error("no router: %s; is another program at that address, or is it not this host's?", error)
        sys.exit(2)
    process.log.info(
        "%s, listening at %s, between %s, for %s, pid %d",
        router.mode,
        ", ".join(router.listen),
        ", ".join(router.sites),
        ", ".join(router.robots) or "any robot and anybody",
        os.getpid(),
    )
    visitors = Visitors(router.robots)
    keys = ExpiryWatch(Path(router.keys)) if router.mode == "secured" else None
    pace = Timer(_LOOK_HZ)
    with ExitStack() as ending:
        ending.push(lambda *raised: process.end(session, *raised))
        for now in process.turns(pace):
            if not pace.due(now):
                continue
            set_tcp_options()
            links = [(link.auth_identifier or "somebody", link.dst) for link in session.info.links()]
            for news in visitors.update(links):
                process.log.info("%s", news)
            process.condition.set_notice("strangers", visitors.strangers)
            if keys is not None:
                process.condition.set_notice("keys", keys.warning(datetime.now(UTC)))
