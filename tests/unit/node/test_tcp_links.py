"""What the kernel is told to do for a connection."""

import os
import platform
import resource
import socket
import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from giraff_core.network import NetworkConfig
from giraff_node.network import link_repair
from giraff_node.network.link_repair import LinkRepair
from giraff_node.network.session import LEASE
from giraff_node.network.tcp_options import RTO_MIN, set_tcp_options
from giraff_node.process.systemd import Notifier
from tests.support.manager import FakeManager

THIN_LINEAR_TIMEOUTS, RTO_MIN_US = 16, 45  # linux/tcp.h


def test_every_connection_ends_with_the_lease_and_repeats_soon() -> None:
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname()) as one,
        socket.socket(socket.AF_UNIX) as another,
    ):
        assert one.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) == 0
        one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 10))  # as Zenoh has it
        set_tcp_options()
        assert one.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) == LEASE * 1000 == 1500
        assert one.getsockopt(socket.IPPROTO_TCP, THIN_LINEAR_TIMEOUTS) == 1
        assert struct.unpack("ii", one.getsockopt(socket.SOL_SOCKET, socket.SO_LINGER, 8))[0] == 0
        major, minor = map(int, platform.release().split(".")[:2])
        if (major, minor) >= (6, 15):
            assert one.getsockopt(socket.IPPROTO_TCP, RTO_MIN_US) * 1e-6 < RTO_MIN + 0.01
        one.sendall(b"it is still open")
        assert another.fileno() >= 0


def test_a_flood_that_takes_all_descriptors_ends_no_service(tmp_path: Path) -> None:
    """Nor does systemd, whose watchdog is still told."""
    manager = FakeManager(str(tmp_path / "notify"))
    notifier = Notifier(manager.environment)
    most, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    os.close(next_free := os.dup(0))
    resource.setrlimit(resource.RLIMIT_NOFILE, (next_free, hard))
    try:
        set_tcp_options()
        notifier.turn(0.0, "well")
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
    assert manager.heard() == ["READY=1", "STATUS=well"]
    manager.close()


def test_connections_are_looked_through_only_while_one_may_be_new(monkeypatch: pytest.MonkeyPatch) -> None:
    """To look through them took a tenth of a service's processor time."""
    looks: list[float] = []
    links = [SimpleNamespace(zid=1, src="tcp/10.0.0.2:7447", dst="tcp/10.0.0.3:40001")]
    info = SimpleNamespace(links=lambda: links)
    session: Any = SimpleNamespace(zid=lambda: "c0ffee", info=info)
    repair = LinkRepair(session, NetworkConfig(), "alpha", None)

    def look(since: float, until: float) -> int:
        """How often they were, from then to then."""
        before = len(looks)
        for step in range(round(since * 10), round(until * 10)):
            monkeypatch.setattr(link_repair, "set_tcp_options", lambda at=step / 10: looks.append(at))
            repair.update(step / 10)
        return len(looks) - before

    open_timeout = 2.0  # s; of services/giraff_node/zenoh/peer.toml
    assert look(0.0, 60.0) < 30
    links.append(SimpleNamespace(zid=2, src="tcp/10.0.0.2:7447", dst="tcp/10.0.0.4:40001"))
    assert look(60.0, 60.0 + open_timeout) >= 8
    assert look(62.0, 120.0) < 30
    with socket.socket():  # no link yet
        assert look(120.0, 120.0 + open_timeout) >= 8
        assert look(122.0, 180.0) < 30
