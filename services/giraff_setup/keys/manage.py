"""`giraff keys`: a CA of one's own, a bundle for each host, and how it stands with them."""

import errno
import os
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import tomlkit
from cryptography import x509

from giraff_keys.certificates import PROGRAM_MADE, CertificateError, addresses_of, common_name, new_authority, new_host
from giraff_keys.files import CA_KEY, KeyFileError, read_authority, read_certificate
from giraff_keys.folder import holding, lay_down
from giraff_keys.host_names import Address, require_address, require_name, without_local
from giraff_node.network.key_bundle import BUNDLE_FILE, CA_CERTIFICATE, HOST_CERTIFICATE, HOST_KEY
from giraff_setup.keys.status import KeyStatus, State, authority_status, host_status, keys_command
from giraff_tools.terminal.page import print_table
from giraff_tools.terminal.text import json_line


def bundle_text(certificate: x509.Certificate, made: datetime) -> str:
    """What is in the `bundle.toml` of this certificate; giraff_node.network.key_bundle reads it."""
    document = tomlkit.document()
    document.add(tomlkit.comment("Written by `giraff keys`: who uses these keys, and until when. host.pem decides."))
    document["name"] = common_name(certificate)
    document["addresses"] = [str(address) for address in without_local(addresses_of(certificate))]
    document["made"] = made
    document["expires"] = certificate.not_valid_after_utc
    return tomlkit.dumps(document)


_DONE: Final = 0
_TO_DO: Final = 1
_REFUSED: Final = 2

_BUNDLE: Final = {CA_CERTIFICATE, HOST_CERTIFICATE, HOST_KEY, BUNDLE_FILE}


class RefusedError(Exception):
    """Nothing was made; the text says why and what to do."""


def now() -> datetime:
    """Certificates know whole seconds, and no time zone but this."""
    return datetime.now(UTC).replace(microsecond=0)


def init(folder: Path, moment: datetime, *, as_json: bool = False) -> int:
    """The whole command `giraff keys init`; its exit code."""
    try:
        ends = make_authority(folder, moment)
    except (RefusedError, OSError) as error:
        return _complain("init", error)
    if as_json:
        print(json_line({"folder": str(folder), "expires": ends}))
        return _DONE
    print(
        f"{folder} is made: a CA that vouches for each host that may reach the robot, until {ends:%Y-%m-%d}.\n"
        f"{folder / CA_KEY} stays on this machine and goes to no robot: who has it can command every robot of it.\n"
        f"Keep a second copy of {folder} where nobody else reads it, and nothing of it in a repository.\n"
        f"Next, for each host and the addresses that others reach it at:\n"
        f"    {keys_command(folder, 'host', 'robot', '192.168.1.20')}"
    )
    return _DONE


def host(
    folder: Path,
    name: str,
    addresses: Sequence[str],
    *,
    days: int,
    renew: bool,
    moment: datetime,
    as_json: bool = False,
) -> int:
    """The whole command `giraff keys host`; its exit code."""
    try:
        ends = make_bundle(folder, name, addresses, days=days, renew=renew, moment=moment)
    except (RefusedError, KeyFileError, CertificateError, OSError) as error:
        return _complain("host", error)
    if as_json:
        print(json_line({"folder": str(folder / name), "expires": ends}))
        return _DONE
    print(
        f"{folder / name} is {'renewed' if renew else 'made'}, valid until {ends:%Y-%m-%d}. "
        f"It belongs on {name} as /etc/giraff/keys;\nthen restart the services there. docs/keys.md has the commands."
    )
    return _DONE


def show(folder: Path, moment: datetime, *, as_json: bool) -> int:
    """The whole command `giraff keys list`; its exit code."""
    try:
        authority, hosts = statuses(folder, moment)
    except (RefusedError, KeyFileError, OSError) as error:
        return _complain("list", error)
    if as_json:
        print(json_line({"folder": str(folder), "ca": authority, "hosts": hosts}))
    else:
        _print_table(authority, hosts)
    states = {status.state for status in (authority, *hosts)}
    if State.UNREADABLE in states:
        return _REFUSED
    return _DONE if states == {State.OK} else _TO_DO


def make_authority(folder: Path, moment: datetime) -> datetime:
    """Make the folder with a new CA in it; when that ends. Raises RefusedError, OSError."""
    if moment < PROGRAM_MADE:
        raise RefusedError(f"this machine's clock says {moment:%Y-%m-%d}: set it, certificates are made from it")
    if not folder.parent.is_dir():
        raise RefusedError(f"{folder.parent}: there is no such folder; make it, or name another one with --folder")
    with holding(folder.parent):
        if (folder / CA_CERTIFICATE).exists() or (folder / CA_KEY).exists():
            raise RefusedError(f"{folder} holds a CA already, and hosts may count on it: --folder names another one")
        if folder.exists() or folder.is_symlink():
            raise RefusedError(f"{folder} is there already: --folder names one that is not, it will be made")
        authority = new_authority(moment)
        # The certificates' folder may well be in a work tree: nothing of it belongs in a repository.
        public = {".gitignore": b"*\n", CA_CERTIFICATE: authority.certificate_pem}
        lay_down(folder, public, {CA_KEY: authority.key_pem})
    return authority.certificate.not_valid_after_utc


def make_bundle(
    folder: Path, name: str, addresses: Sequence[str], *, days: int, renew: bool, moment: datetime
) -> datetime:
    """Make or renew a host's bundle; when it ends. Raises RefusedError, KeyFileError, CertificateError, OSError."""
    try:
        bundle, reachable = folder / require_name(name), [require_address(text) for text in addresses]
    except ValueError as error:
        raise RefusedError(str(error)) from error
    _require_folder(folder)
    with holding(folder):
        if renew:
            _require_bundle(bundle, folder)
        elif bundle.exists() or bundle.is_symlink():
            raise RefusedError(
                f"{bundle} is there already, and {name} may be using it: for a new certificate and a new key in its "
                f"place, {keys_command(folder, 'host', name, '--renew')}"
            )
        elif not reachable:
            raise RefusedError(f"no address: name each one at which other hosts reach {name}, like 192.168.1.20")
        authority = read_authority(folder)
        identity = new_host(authority, name, reachable or _old_addresses(bundle), moment, days)
        public = {
            CA_CERTIFICATE: authority.certificate_pem,
            HOST_CERTIFICATE: identity.certificate_pem,
            BUNDLE_FILE: bundle_text(identity.certificate, moment).encode(),
        }
        lay_down(bundle, public, {HOST_KEY: identity.key_pem}, renew=renew)
    return identity.certificate.not_valid_after_utc


def statuses(folder: Path, moment: datetime) -> tuple[KeyStatus, list[KeyStatus]]:
    """Of the CA, and of each host. Raises RefusedError, KeyFileError, OSError."""
    _require_folder(folder)
    with holding(folder):
        bundles = sorted(path for path in folder.iterdir() if path.is_dir() and not path.name.startswith("."))
        authority = read_certificate(folder / CA_CERTIFICATE)
        return authority_status(folder, moment), [host_status(bundle, authority, moment) for bundle in bundles]


def _require_folder(folder: Path) -> None:
    if (folder / HOST_CERTIFICATE).exists():
        raise RefusedError(f"{folder} is the bundle of one host: --folder names the folder around it, with the CA")
    if not (folder / CA_CERTIFICATE).exists():
        raise RefusedError(
            f"{folder / CA_CERTIFICATE} is not here: go to where the CA was made, or name its folder with --folder; "
            f"a first one is made by {keys_command(folder, 'init')}"
        )


def _require_bundle(bundle: Path, folder: Path) -> None:
    """Only what was made here may be replaced."""
    if bundle.is_symlink() or not bundle.is_dir():
        raise RefusedError(
            f"{bundle} is not there, so there is nothing to renew: "
            f"{keys_command(folder, 'host', bundle.name, 'ADDRESS')}"
        )
    if strange := sorted(path.name for path in bundle.iterdir() if path.name not in _BUNDLE):
        raise RefusedError(f"{bundle} would be replaced, and {', '.join(strange)} with it: move that elsewhere")


def _old_addresses(bundle: Path) -> tuple[Address, ...]:
    """Those the certificate in this bundle has. Raises RefusedError."""
    try:
        return without_local(addresses_of(read_certificate(bundle / HOST_CERTIFICATE)))
    except KeyFileError as error:
        raise RefusedError(f"{error}; without it, name the addresses of {bundle.name} again") from error


def _print_table(authority: KeyStatus, hosts: Sequence[KeyStatus]) -> None:
    print_table(
        ("name", "expires", ">days left", "state", "addresses"),
        [
            (
                status.name,
                f"{status.expires:%Y-%m-%d}" if status.expires else "",
                "" if status.days_left is None else str(status.days_left),
                status.state,
                ", ".join(status.addresses),
            )
            for status in (authority, *hosts)
        ],
    )
    for status in (authority, *hosts):
        for sentence in status.to_do:
            print(f"{status.name}: {sentence}")
    if not hosts:
        print("No host has a bundle yet.")


def _complain(word: str, error: Exception) -> int:
    text = str(error)
    if isinstance(error, OSError):
        text = f"{error.filename}: {error.strerror}" if error.filename else os.strerror(error.errno or 0)
        if isinstance(error, PermissionError):
            text += ": whose is it? The one who made the CA makes the bundles, too"
        elif error.errno == errno.EROFS:
            text += "; name a folder where you may write with --folder"
    print(f"giraff keys {word}: {text}", file=sys.stderr)
    return _REFUSED
