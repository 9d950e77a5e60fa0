"""What the kernel is told to do for a connection."""

from __future__ import annotations

import platform
import socket
import struct

from giraff_node.network.session import LEASE
from giraff_node.network.tcp_options import RTO_MIN, set_tcp_options

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
