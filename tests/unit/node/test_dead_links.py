"""How long a connection waits for an answer."""

from __future__ import annotations

import socket

from giraff_node.dead_links import limit_dead_links
from giraff_node.session import LEASE


def test_every_connection_ends_with_the_lease() -> None:
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname()) as one,
        socket.socket(socket.AF_UNIX) as another,
    ):
        assert one.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) == 0
        limit_dead_links()
        assert one.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) == LEASE * 1000 == 1500
        one.sendall(b"it is still open")
        assert another.fileno() >= 0
