"""Zenoh's TLS takes these certificates, and nobody else's."""

from __future__ import annotations

import contextlib
import json
import shutil
import socket
import threading
import time
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
import zenoh

from giraff_cli.keys import now
from giraff_node.session import close_session
from tests.unit.keys.folders import DAY, authority, bundle

REFUSED_AFTER = 1.0  # s: as long a stranger tries, several times; a sample of a friend takes milliseconds
ARRIVES_WITHIN = 20.0  # s, on a machine that is busy with something else


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def configuration(keys: Path, *, shown: bool, listen: str = "", connect: str = "") -> zenoh.Config:
    """A peer that talks TLS only, and shows its certificate if asked to."""
    tls: dict[str, Any] = {"root_ca_certificate": str(keys / "ca.pem"), "enable_mtls": shown}
    if shown:
        for way in ("listen", "connect"):
            tls |= {f"{way}_certificate": str(keys / "host.pem"), f"{way}_private_key": str(keys / "host.key")}
    peer = {
        "mode": "peer",
        "listen": {"endpoints": [listen] if listen else []},
        "connect": {
            "endpoints": [connect] if connect else [],
            "timeout_ms": 0,
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


def reaches(caller: Path, called: Path, host: str = "127.0.0.1", *, shown: bool = True, within: float) -> bool:
    """Whether a sample of the caller arrives at the one that is called, at this name of the machine."""
    port, arrived = free_port(), threading.Event()
    listening = configuration(called, shown=True, listen=f"tls/0.0.0.0:{port}")
    calling = configuration(caller, shown=shown, connect=f"tls/{host}:{port}")
    with opened(listening) as one, opened(calling) as other:
        one.declare_subscriber("sample", lambda _sample: arrived.set())
        deadline = time.monotonic() + within
        while not arrived.is_set() and time.monotonic() < deadline:
            other.put("sample", b"")
            arrived.wait(0.05)
    return arrived.is_set()


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


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_hosts_of_one_ca_talk(folders: Path, host: str) -> None:
    assert reaches(folders / "ours/laptop", folders / "ours/robot", host, within=ARRIVES_WITHIN)


@pytest.mark.parametrize("caller", ["theirs/laptop", "stranger", "ours/expired"])
def test_a_stranger_and_an_expired_host_are_refused(folders: Path, caller: str) -> None:
    assert not reaches(folders / caller, folders / "ours/robot", within=REFUSED_AFTER)


def test_one_who_shows_no_certificate_is_refused(folders: Path) -> None:
    assert not reaches(folders / "ours/laptop", folders / "ours/robot", shown=False, within=REFUSED_AFTER)


@pytest.mark.parametrize("called", ["theirs/laptop", "ours/expired"])
def test_nobody_talks_to_a_stranger_or_an_expired_host_that_listens(folders: Path, called: str) -> None:
    assert not reaches(folders / "ours/laptop", folders / called, within=REFUSED_AFTER)


def test_a_host_counts_only_at_its_addresses(folders: Path) -> None:
    assert not reaches(folders / "ours/laptop", folders / "ours/robot", "127.0.0.2", within=REFUSED_AFTER)
