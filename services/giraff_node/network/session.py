"""The Zenoh session of a process: table `[network]` of the robot file.

What the session says to Zenoh, and why, is in the files of `deploy/zenoh`: `peer.toml` for every network, one file
for each mode, and `recorder.toml` for who records. Here this host's own endpoints, certificates and rules are put in.
"""

from __future__ import annotations

import functools
import os
import threading
import tomllib
from pathlib import Path
from typing import Any, Final

import msgspec
import zenoh

from giraff_core.access import access_control
from giraff_core.network import NetworkConfig, with_port
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.key_bundle import CA_CERTIFICATE, HOST_CERTIFICATE, HOST_KEY, BundleError, read_bundle

_FILES: Final = Path(__file__).parents[1] / "zenoh"
_CLOSE_TIMEOUT: Final = 1.0  # s

CERTIFICATES: Final = {
    "root_ca_certificate": CA_CERTIFICATE,
    "listen_certificate": HOST_CERTIFICATE,
    "listen_private_key": HOST_KEY,
    "connect_certificate": HOST_CERTIFICATE,
    "connect_private_key": HOST_KEY,
}
"""Zenoh's name -> file of the host's bundle, as `giraff keys host` makes it."""


def session_config(
    network: NetworkConfig, robot: str, *, visiting: bool = False, records: bool = False
) -> dict[str, Any]:
    """The Zenoh configuration of a peer of `robot`, as nested dictionaries. Raises ConfigError.

    `visiting`: it is gone in a moment, and leaves the rendezvous to those who stay. A session that waits for the
    rendezvous to become free does not come back from its close, either. `records`: it hears what is no sample of ours.
    """
    config = settings("peer", network.mode, *(("recorder",) if records else ()))
    _, _, port = network.rendezvous.rpartition(":")
    protocol = "tls" if network.mode == "secured" else "tcp"
    reach = "127.0.0.1" if network.local else "0.0.0.0"  # noqa: S104  other hosts are to reach it
    # Where there is no multicast, or a cable was cut, the other hosts find this one at its rendezvous.
    meeting = network.rendezvous if network.local else f"{reach}:{port}"
    retried = "#exit_on_failure=false;retry_period_init_ms=500;retry_period_max_ms=1000"
    # Bound before any link is made: a peer that hears of one with no address never dials it, not even when it has one.
    first = "#exit_on_failure=true"
    own = [f"{reach}:0"]
    if not network.local:
        # What listens at all addresses is told by those that have a carrier: the processes of a host without a network
        # would meet at the rendezvous, and not each other.
        own.append("127.0.0.1:0")
    config["listen"]["endpoints"] = [
        *(() if visiting else (f"{protocol}/{meeting}{retried}",)),
        *(f"{protocol}/{address}{first}" for address in own),
    ]
    # The loopback first: with only `lo` up, two peers of one host would never find each other.
    others = () if network.local else (*network.connect, *filter(None, [network.router]))
    config["connect"]["endpoints"] = [f"{protocol}/{with_port(address)}" for address in (network.rendezvous, *others)]
    if network.local:
        config["scouting"]["multicast"]["enabled"] = False
    if network.site:
        config["region_name"] = network.site
    if network.mode == "secured":
        keys = Path(network.keys)
        config["transport"]["link"]["tls"] |= certificates(keys)
        # Whose host this is matters only for what a router may say to it.
        me = _host_of(keys) if network.access.routers else ""
        config["access_control"] |= access_control(network.access, robot, me)
    return config


def open_session(network: NetworkConfig, robot: str, *, visiting: bool = False, records: bool = False) -> zenoh.Session:
    """Join the network of `robot`, or visit it (`session_config`). Raises `zenoh.ZError` and ConfigError."""
    if network.session_file:
        return zenoh.open(zenoh.Config.from_file(network.session_file))
    return zenoh.open(
        zenoh.Config.from_json5(
            msgspec.json.encode(session_config(network, robot, visiting=visiting, records=records)).decode()
        )
    )


def close_session(session: zenoh.Session, within: float = _CLOSE_TIMEOUT) -> bool:
    """Leave the network; False when Zenoh does not come back from it: its close can hang, the process must not."""
    closing = threading.Thread(target=session.close, daemon=True)
    closing.start()
    closing.join(within)
    return not closing.is_alive()


def settings(*names: str) -> dict[str, Any]:
    """What these files of `deploy/zenoh` say; the later ones count before the earlier ones."""
    read = (tomllib.loads((_FILES / f"{name}.toml").read_text(encoding="utf-8")) for name in names)
    return functools.reduce(_merged, read)


def _merged(common: dict[str, Any], special: dict[str, Any]) -> dict[str, Any]:
    """Both; where both have a table, its fields together."""
    merged = {**common}
    for name, value in special.items():
        ours = common.get(name)
        merged[name] = _merged(ours, value) if isinstance(ours, dict) and isinstance(value, dict) else value
    return merged


def certificates(folder: Path) -> dict[str, str]:
    """A host's bundle, as Zenoh takes it. Raises ConfigError: Zenoh's own word would be that no link comes about."""
    for name in sorted(set(CERTIFICATES.values())):
        path = folder / name
        try:
            path.read_bytes()
        except OSError as error:
            raise ConfigError(
                f"{path}: {error.strerror}; the network is secured: put this host's bundle of `giraff keys host` there"
            ) from error
    return {field: os.fsencode(folder / name).decode(errors="replace") for field, name in CERTIFICATES.items()}


def _host_of(folder: Path) -> str:
    """The name in the certificate of this host's bundle. Raises ConfigError."""
    try:
        return read_bundle(folder).name
    except BundleError as error:
        raise ConfigError(
            f"{error}; [network.access] has routers, and what one may say depends on the host: "
            "make its bundle again with `giraff keys host --renew`"
        ) from error


LEASE: Final = settings("peer")["transport"]["link"]["tx"]["lease"] / 1000
"""s without a word after which a link is dead."""
