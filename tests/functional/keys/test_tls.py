"""Zenoh's TLS takes these certificates, and nobody else's."""

import contextlib
import json
import shutil
import socket
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
import zenoh

from giraff_node.network.session import close_session
from giraff_setup.keys.manage import now
from tests.support.waiting import wait
from tests.unit.keys.folders import DAY, authority, bundle


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def configuration(keys: Path, *calls: str, shown: bool = True, listen: str = "") -> zenoh.Config:
    """A peer that talks TLS only, and shows its certificate if asked to."""
    tls: dict[str, Any] = {"root_ca_certificate": str(keys / "ca.pem"), "enable_mtls": shown}
    if shown:
        for way in ("listen", "connect"):
            tls |= {f"{way}_certificate": str(keys / "host.pem"), f"{way}_private_key": str(keys / "host.key")}
    peer = {
        "mode": "peer",
        "listen": {"endpoints": [listen] if listen else []},
        "connect": {
            "endpoints": [*calls],
            "timeout_ms": -1,  # again and again
            "exit_on_failure": False,
            "retry": {"period_init_ms": 100, "period_max_ms": 200},
        },
        "scouting": {"multicast": {"enabled": False}},
        "transport": {"link": {"protocols": ["tls"], "tls": tls}},
    }
    return zenoh.Config.from_json5(json.dumps(peer))


@contextlib.contextmanager
def opened(config: zenoh.Config) -> Iterator[zenoh.Session]:
    session = zenoh.open(config)
    try:
        yield session
    finally:
        assert close_session(session)


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two CAs: ours, with robot, laptop and one that is expired, and a stranger's."""
    root, made = tmp_path_factory.mktemp("tls"), now()
    ours, theirs = authority(root / "ours", made - 10 * DAY), authority(root / "theirs", made)
    for name in ("robot", "laptop"):
        bundle(ours, name, made)
    bundle(ours, "expired", made - DAY - timedelta(minutes=1), days=1)
    stranger = bundle(theirs, "laptop", made)
    # A stranger who has our CA's certificate, which is no secret: then it is the other side that refuses.
    shutil.copytree(stranger, root / "stranger")
    shutil.copy(ours / "ca.pem", root / "stranger" / "ca.pem")
    return root


def test_a_host_takes_calls_of_its_own_ca_alone(folders: Path) -> None:
    """Friends call last, one after the other: by then strangers have called as often, and would have come through."""
    port, arrived = free_port(), set[str]()
    strangers = {
        "another CA's": configuration(folders / "theirs/laptop", f"tls/127.0.0.1:{port}"),
        "another CA's with our CA": configuration(folders / "stranger", f"tls/127.0.0.1:{port}"),
        "expired": configuration(folders / "ours/expired", f"tls/127.0.0.1:{port}"),
        "without a certificate": configuration(folders / "ours/laptop", f"tls/127.0.0.1:{port}", shown=False),
        "at no address of it": configuration(folders / "ours/laptop", f"tls/127.0.0.2:{port}"),
    }
    with contextlib.ExitStack() as stack:
        robot = stack.enter_context(opened(configuration(folders / "ours/robot", listen=f"tls/0.0.0.0:{port}")))
        robot.declare_subscriber("from/*", lambda sample: arrived.add(sample.payload.to_string()))
        callers = {name: stack.enter_context(opened(config)) for name, config in strangers.items()}
        for host in ("127.0.0.1", "localhost", "127.0.0.1"):
            arrived.discard(host)
            friend = opened(configuration(folders / "ours/laptop", f"tls/{host}:{port}"))
            callers[host] = stack.enter_context(friend)

            def has_come(host: str = host) -> bool:
                for name, session in callers.items():
                    session.put("from/caller", name)
                return host in arrived

            wait(has_come, 60.0, what=f"a friend's word at {host}")
        assert [list(callers[name].info.links()) for name in strangers] == [[]] * len(strangers)
    assert arrived == {"127.0.0.1", "localhost"}


def test_nobody_talks_to_a_stranger_or_an_expired_host_that_listens(folders: Path) -> None:
    """It calls all of them as often, and a friend that is there only then."""
    ports = {name: free_port() for name in ("theirs/laptop", "ours/expired", "ours/robot")}
    arrived = set[str]()
    with contextlib.ExitStack() as stack:

        def listen(name: str) -> None:
            config = configuration(folders / name, listen=f"tls/127.0.0.1:{ports[name]}")
            session = stack.enter_context(opened(config))
            session.declare_subscriber("word", lambda _: arrived.add(name))

        listen("theirs/laptop")
        listen("ours/expired")
        calls = [f"tls/127.0.0.1:{port}" for port in ports.values()]
        caller = stack.enter_context(opened(configuration(folders / "ours/laptop", *calls)))
        listen("ours/robot")

        def has_come() -> bool:
            caller.put("word", "")
            return "ours/robot" in arrived

        wait(has_come, 60.0)
        assert len(list(caller.info.links())) == 1
    assert arrived == {"ours/robot"}
