"""Whether an address that somebody typed answers at all."""

import socket
from collections.abc import Mapping, Sequence
from typing import Final

from giraff_core.network import IPV4_ALONE, host_and_port
from giraff_schemas.trouble import Trouble

NO_NAME: Final = Trouble("no such name is known here (DNS, /etc/hosts)", "give its address")
_ANSWERS_WITHIN: Final = 2.0  # s; a host on Wi-Fi takes up to one


def find_silent(addresses: Sequence[str]) -> dict[str, str]:
    """Return the addresses at which nobody takes a connection, each with the reason."""
    return {address: why for address in addresses if (why := _silence(address))}


def silence_text(silent: Mapping[str, str]) -> str:
    """Return such addresses with their reasons as one line."""
    return "; ".join(f"{address}: {why}" for address, why in silent.items())


def address_fault(address: str) -> str:
    """Why this cannot be an address; empty: it can."""
    try:
        host_and_port(address)
    except ValueError as error:
        return str(error)
    return ""


def _silence(address: str) -> str:
    if why := address_fault(address):
        return why
    host, port = host_and_port(address)
    try:
        socket.create_connection((host, port), _ANSWERS_WITHIN).close()
    except OSError as error:
        if ":" in host:
            return f"{error.strerror or error}; {IPV4_ALONE}"
        return str(NO_NAME) if isinstance(error, socket.gaierror) else str(error.strerror or error)
    return ""
