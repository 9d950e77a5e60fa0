"""What a run holds of this host: ports that are free, and its robot's name."""

import random
import socket
from typing import Final

_OWN_PORTS: Final = (20_000, 32_000)  # below Linux's range for outgoing connections, 32768 to 60999


def free_port() -> int:
    """A port of the loopback that nobody listens on, and that no outgoing connection is given by the kernel.

    One of the kernel's would be free now and taken in a moment; a peer that calls it before anybody listens could
    even be given the port for its own end, and be connected to itself.
    """
    while True:
        port = random.randrange(*_OWN_PORTS)
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port


def port_or_any(port: int) -> int:
    """This one, if a server can have it on all of this host's addresses; else 0, for which the kernel gives any."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a server that has just ended has left it
        try:
            probe.bind(("", port))
        except OSError:
            return 0
    return port


def claim(robot: str) -> socket.socket | None:
    """Hold a robot's name among this host's runs, as long as the socket lives; None when another run holds it.

    The liveliness of a namesake shows only where there is a network to show it on.
    """
    held = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        held.bind(f"\0giraff run {robot}")  # an abstract name: it goes with the process, and leaves no file
    except OSError:
        held.close()
        return None
    return held
