"""By which certificate browsers know this service.

Where the network is secured it is the host's own. Else one is made at the first start: of a certificate authority whose
private key is thrown away at once, so a phone that trusts it trusts this one host only, and nobody else can use it.
"""

import ssl
import tempfile
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Final, NamedTuple

from cryptography.hazmat.primitives import hashes

from giraff_core.network import NetworkConfig
from giraff_keys.certificates import PROGRAM_MADE, addresses_of, new_authority, new_host
from giraff_keys.files import KeyFileError, is_pair, read_certificate, read_key
from giraff_keys.folder import holding, lay_down
from giraff_keys.host_names import Address, require_address, with_local
from giraff_node.network.key_bundle import CA_CERTIFICATE, EXPIRES_SOON, HOST_CERTIFICATE, HOST_KEY
from giraff_schemas.trouble import NO_TROUBLE, Trouble

FOLDER: Final = "web-keys"
"""In the service's state folder."""
_LIFE_DAYS: Final = 396
"""With the day by which it is backdated 397: what iOS takes at most is 398."""


class CertificateProblemError(Exception):
    """There is no certificate to begin with; the text says why, with the way out."""


class Certificate(NamedTuple):
    """As the server takes it."""

    context: ssl.SSLContext
    authority: bytes
    """PEM, of what a device installs to trust the service."""
    fingerprint: str
    """SHA-256 of the certificate in DER, in hexadecimal digits."""


def own_names(hostname: str, addresses: Iterable[str], further: Iterable[str]) -> tuple[Address, ...]:
    """At which browsers may reach this host. Raises CertificateProblemError where one of `further` can be none."""
    found = []
    for text in (hostname, "" if "." in hostname else f"{hostname}.local", *sorted(addresses)):
        try:
            found.append(require_address(text))
        except ValueError:  # a machine may be called what no browser can ask for
            continue
    for text in further:
        try:
            found.append(require_address(text))
        except ValueError as error:
            raise CertificateProblemError(f"[web] names: {error}") from error
    return with_local(found)


def host_certificate(folder: Path) -> Certificate:
    """Of a secured network: the bundle of this host. Raises CertificateProblemError."""
    return _loaded(folder, "copy this host's bundle there again; `giraff keys list` shows what is wrong with it")


def made_certificate(
    state: Path, hostname: str, names: Iterable[Address], now: datetime, passing: Iterable[str] = ()
) -> tuple[Certificate, Trouble]:
    """Return the certificate of the last start if it still fits, else a new one; and what devices may refuse about it.

    `state`: the service's state folder. `passing`: those of `names` that interfaces have now. While the certificate
    names one of them, another that has come beside it renews nothing, such as a VPN's. Neither does a clock before the
    certificate's beginning: a boot without a clock. Both would cost the trust of the devices.
    """
    wanted, may_lack = with_local(names), {require_address(address) for address in passing}
    try:
        state.mkdir(parents=True, exist_ok=True)
        with holding(state):
            if not _fits(state / FOLDER, wanted, may_lack, now):
                _make(state / FOLDER, hostname, wanted, now)
        notice = _early(state / FOLDER, now) or _lacking(state / FOLDER, may_lack)
        return _loaded(state / FOLDER, "remove the folder, and start again"), notice
    except OSError as error:
        with tempfile.TemporaryDirectory() as folder:
            _make(Path(folder) / FOLDER, hostname, wanted, now)
            why = Trouble(
                f"{error.filename or state}: {error.strerror or error}: the certificate cannot be kept, and devices "
                "must trust another one after each start",
                "correct the folder's rights",
            )
            return _loaded(Path(folder) / FOLDER, "start again"), why


def for_this_host(
    network: NetworkConfig,
    state: Path,
    hostname: str,
    names: Iterable[Address],
    now: datetime,
    passing: Iterable[str] = (),
) -> tuple[Certificate, Trouble]:
    """The one that counts on this network, and what is to be told of it. Raises CertificateProblemError."""
    if is_secured(network):
        return host_certificate(Path(network.keys)), NO_TROUBLE
    return made_certificate(state, hostname, names, now, passing)


def is_secured(network: NetworkConfig) -> bool:
    """Whether the hosts have certificates of their own, and strangers may not even watch."""
    return network.mode == "secured" and not network.session_file


def _fits(folder: Path, wanted: Iterable[Address], may_lack: set[Address], now: datetime) -> bool:
    try:
        authority, certificate = (read_certificate(folder / name) for name in (CA_CERTIFICATE, HOST_CERTIFICATE))
        if not is_pair(certificate, read_key(folder / HOST_KEY)) or certificate.issuer != authority.subject:
            return False
    except KeyFileError:
        return False
    there = {*addresses_of(certificate)}
    is_named = {*wanted} - there <= may_lack and (not may_lack or bool(may_lack & there))
    return is_named and now < certificate.not_valid_after_utc - EXPIRES_SOON


def _lacking(folder: Path, addresses: set[Address]) -> Trouble:
    """Return the trouble with addresses of this host that the certificate does not name."""
    lacking = ", ".join(sorted(map(str, addresses - {*addresses_of(read_certificate(folder / HOST_CERTIFICATE))})))
    if not lacking:
        return NO_TROUBLE
    remedy = f"open the page at another address; or remove {folder}, start again, and let devices trust it anew"
    return Trouble(f"the certificate does not name {lacking}: browsers refuse the page there", remedy)


def _early(folder: Path, now: datetime) -> Trouble:
    """Return the trouble with a certificate that begins later than `now`. The certificate has been read before."""
    begins = read_certificate(folder / HOST_CERTIFICATE).not_valid_before_utc
    if now >= begins:
        return NO_TROUBLE
    early = f"the certificate begins on {begins:%Y-%m-%d}, but at the start the clock stood at {now:%Y-%m-%d}"
    return Trouble(early, f"set the clock; if it was right, remove {folder} and start again")


def _make(folder: Path, hostname: str, names: Iterable[Address], now: datetime) -> None:
    """The folder around it is held. Raises OSError."""
    begins = max(now, PROGRAM_MADE)
    authority = new_authority(begins)
    name = f"Giraff web on {hostname}"[:64]  # X.509 has room for so many characters
    host = new_host(authority, name, tuple(names), begins, _LIFE_DAYS)
    public = {CA_CERTIFICATE: authority.certificate_pem, HOST_CERTIFICATE: host.certificate_pem}
    lay_down(folder, public, {HOST_KEY: host.key_pem}, renew=folder.exists())


def _loaded(folder: Path, remedy: str) -> Certificate:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(folder / HOST_CERTIFICATE, folder / HOST_KEY)
        fingerprint = read_certificate(folder / HOST_CERTIFICATE).fingerprint(hashes.SHA256()).hex()
        return Certificate(context, (folder / CA_CERTIFICATE).read_bytes(), fingerprint)
    except KeyFileError as error:
        raise CertificateProblemError(f"{error}; {remedy}") from error
    except OSError as error:  # ssl.SSLError is one, too
        told = f"{error.filename}: {error.strerror}" if error.filename else f"certificate and key: {error}"
        raise CertificateProblemError(f"{folder}: {told}; {remedy}") from error
