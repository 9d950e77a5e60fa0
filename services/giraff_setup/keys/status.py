"""How it stands with a CA and the bundles of its hosts, and what to do about it."""

import shlex
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import InvalidSignature

from giraff_keys.certificates import addresses_of, common_name
from giraff_keys.files import CA_KEY, KeyFileError, is_pair, read_certificate, read_key
from giraff_keys.folder import is_readable_by_others
from giraff_keys.host_names import without_local
from giraff_node.network.key_bundle import (
    CA_CERTIFICATE,
    EXPIRES_SOON,
    HOST_CERTIFICATE,
    HOST_KEY,
    BundleError,
    read_bundle,
)


class State(StrEnum):
    """Of a certificate and its key; the first that applies is the one that is told."""

    UNREADABLE = "cannot be read"
    EXPOSED = "key readable by others"
    STRANGE = "not signed by this CA"
    NO_PAIR = "key does not match"
    MIXED_UP = "bundle mixed up"
    EXPIRED = "expired"
    EARLY = "not yet valid"
    SOON = "expires soon"
    OK = "ok"


@dataclass(frozen=True, kw_only=True)
class KeyStatus:
    """What `giraff keys list` tells of one certificate."""

    name: str
    addresses: tuple[str, ...] = ()
    expires: datetime | None = None
    days_left: int | None = None
    """Whole days; below zero since it expired."""
    state: State = State.OK
    to_do: tuple[str, ...] = ()
    """One sentence each."""


def authority_status(folder: Path, now: datetime) -> KeyStatus:
    """Of the CA itself. Raises KeyFileError where no certificate can be read."""
    certificate = read_certificate(folder / CA_CERTIFICATE)
    found = [*_validity(certificate, now, "make a new CA in another folder, and from it new bundles for all hosts")]
    key = folder / CA_KEY
    if key.exists():  # else it is kept elsewhere, which is good
        found += _key_standing(certificate, key, "one of both is of another CA: put the right one back")
    return _status(common_name(certificate), certificate, found, now)


def host_status(folder: Path, authority: x509.Certificate, now: datetime) -> KeyStatus:
    """Of one host's bundle."""
    again = _renewal(folder)
    try:
        certificate = read_certificate(folder / HOST_CERTIFICATE)
        bundled = read_certificate(folder / CA_CERTIFICATE)
        bundle = read_bundle(folder)
    except (KeyFileError, BundleError) as error:
        return KeyStatus(name=folder.name, state=State.UNREADABLE, to_do=(f"{error}; {again}",))
    found = [*_validity(certificate, now, again), *_key_standing(certificate, folder / HOST_KEY, again)]
    if bundled != authority or not _is_signed_by(certificate, authority):
        found.append((State.STRANGE, again))
    if folder.name != common_name(certificate):
        found.append((State.MIXED_UP, f"it is the bundle of {common_name(certificate)!r}: call the folder so again"))
    elif (bundle.name, bundle.expires) != (folder.name, certificate.not_valid_after_utc):
        found.append((State.MIXED_UP, f"bundle.toml is of another certificate: {again}"))
    return _status(folder.name, certificate, found, now)


_Finding = tuple[State, str]


def _status(name: str, certificate: x509.Certificate, found: list[_Finding], now: datetime) -> KeyStatus:
    found.sort(key=lambda finding: [*State].index(finding[0]))
    return KeyStatus(
        name=name,
        addresses=tuple(str(address) for address in without_local(addresses_of(certificate))),
        expires=certificate.not_valid_after_utc,
        days_left=(certificate.not_valid_after_utc - now) // timedelta(days=1),
        state=found[0][0] if found else State.OK,
        to_do=tuple(dict.fromkeys(f"{state}: {what}" for state, what in found)),
    )


def _validity(certificate: x509.Certificate, now: datetime, again: str) -> list[_Finding]:
    if now < certificate.not_valid_before_utc:
        return [(State.EARLY, f"this machine's clock says {now:%Y-%m-%d %H:%M} UTC: set it, if it is wrong")]
    left = certificate.not_valid_after_utc - now
    if left <= timedelta():
        return [(State.EXPIRED, again)]
    return [(State.SOON, again)] if left < EXPIRES_SOON else []


def _key_standing(certificate: x509.Certificate, path: Path, again: str) -> list[_Finding]:
    try:
        key = read_key(path)
        exposed = is_readable_by_others(path)
    except KeyFileError as error:
        return [(State.UNREADABLE, f"{error}; {again}")]
    found = [] if is_pair(certificate, key) else [(State.NO_PAIR, again)]
    if exposed:
        found.append(
            (State.EXPOSED, f"chmod 600 {shlex.quote(str(path))}; if others use this machine, take it for lost")
        )
    return found


def _is_signed_by(certificate: x509.Certificate, authority: x509.Certificate) -> bool:
    try:
        certificate.verify_directly_issued_by(authority)
    except (ValueError, TypeError, InvalidSignature):
        return False
    return True


def _renewal(folder: Path) -> str:
    """The command that makes a new certificate, and what it is for."""
    return f"{keys_command(folder.parent, 'host', folder.name, '--renew')}, then copy it to the host"


def keys_command(folder: Path, *words: str) -> str:
    """`giraff keys …` on this folder, as one types it."""
    named = () if folder == Path("keys") else ("--folder", str(folder))
    return shlex.join(("giraff", "keys", *words, *named))
