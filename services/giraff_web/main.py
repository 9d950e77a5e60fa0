"""giraff_web: the process."""

import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec

from giraff_node import Node
from giraff_node.network.host_addresses import host_addresses
from giraff_node.picture_client import PictureClient
from giraff_node.process.libraries import missing_library
from giraff_node.process.state import state_directory
from giraff_node.process.unix_socket import listen_at
from giraff_schemas.health import WebPage
from giraff_schemas.services import WEB
from giraff_schemas.text import plain
from giraff_schemas.trouble import Trouble
from giraff_web.config import WebConfig
from giraff_web.messages import Room
from giraff_web.server.host import RIGHTS, HostSocket, own_socket
from giraff_web.service import Web

if TYPE_CHECKING:
    from giraff_web.server.server import Site

_REFUSED: Final = 2


def main() -> None:
    if why := missing_library(WEB):
        print(f"giraff_web: {why}", file=sys.stderr)
        sys.exit(_REFUSED)
    with Node("web", WebConfig) as node:
        run_web(node, lambda addresses: _log_addresses(node, addresses))


def run_web(node: Node[WebConfig], announce: Callable[[list[str]], None]) -> None:
    """Serve the pages until the node's end. SystemExit with 2, after a line in the log, where that cannot be.

    `announce`: takes the addresses to open, at the start and after each use of one of them, in a thread of its own.
    """
    from giraff_web.server.certificates import CertificateProblemError  # noqa: PLC0415  its libraries may be missing
    from giraff_web.server.server import PortError, Server  # noqa: PLC0415

    open_source = partial(PictureClient, node.network, node.robot.name)
    try:
        room = _room(node.config.room)
        config = _open_at(node)
        site = _site(node, config)
        with _host_socket(node) as host:
            server = Server(config, site, announce, node.log.info, node.fail, host=host)
            with closing(server):
                server.start()
                node.set_page(
                    WebPage(port=server.port, hosts=site.reached_at, certificate=site.certificate.fingerprint)
                )
                node.run(Web(node, config, node.robot, server, node.log.info, room, open_source))
    except (_RoomError, CertificateProblemError, PortError) as error:
        node.log.error("%s", error)
        sys.exit(_REFUSED)


@contextmanager
def _host_socket(node: Node[WebConfig]) -> Iterator[HostSocket | None]:
    """Where `giraff web --devices` asks; None, after a notice, where there can be no socket."""
    path = own_socket()
    try:
        listener = listen_at(path, RIGHTS)
    except OSError as error:
        node.set_notice(
            "devices",
            Trouble(
                f"{path}: giraff web --devices cannot ask there: {error.strerror or error}",
                "let XDG_RUNTIME_DIR name a directory with a short path that this user may write to",
            ),
        )
        yield None
        return
    try:
        with listener:
            yield HostSocket(node.robot.name, listener)
    finally:
        with suppress(OSError):
            path.unlink()


class _RoomError(Exception):
    """The file of the room cannot be used."""


def _open_at(node: Node[WebConfig]) -> WebConfig:
    """The configuration, with the address of a service that keeps off the network."""
    config = node.config
    return msgspec.structs.replace(config, address=config.address or "127.0.0.1") if node.network.local else config


def _site(node: Node[WebConfig], config: WebConfig) -> "Site":
    """Raises CertificateProblemError."""
    from giraff_web.server import certificates  # noqa: PLC0415
    from giraff_web.server.server import Site  # noqa: PLC0415

    network = node.network
    found = frozenset() if network.local else host_addresses()
    given = {config.address} if config.address else set()
    addresses = found | given
    names = certificates.own_names(node.hostname, addresses, config.names)
    state = state_directory(node.robot.name)
    passing = found - given - {*config.names}
    certificate, notice = certificates.for_this_host(network, state, node.hostname, names, datetime.now(UTC), passing)
    node.set_notice("certificate", notice)
    reached_at = [config.address] if config.address else [*config.names, *sorted(addresses)]
    return Site(
        certificate=certificate,
        names=tuple(str(name) for name in names),
        reached_at=tuple(dict.fromkeys(reached_at)) or ("localhost",),
        strangers_watch=not certificates.is_secured(network),
        robot=node.robot.name,
    )


def _room(path: str) -> Room | None:
    """Raises _RoomError."""
    if not path:
        return None
    try:
        return msgspec.json.decode(Path(path).read_bytes(), type=Room)
    except OSError as error:
        raise _RoomError(f"[web] room: {path} cannot be read: {error.strerror}") from error
    except (msgspec.MsgspecError, ValueError, RecursionError) as error:
        raise _RoomError(f"[web] room: {path} is no room: {plain(error)}") from error


def _log_addresses(node: Node[WebConfig], addresses: list[str]) -> None:
    for address in addresses:
        node.log.info("to drive, open %s", address)
