"""A private certificate authority (CA) and certificates of hosts, as Zenoh's TLS takes them. No file and no clock."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Final

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric.ec import SECP256R1, EllipticCurvePrivateKey, generate_private_key
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from giraff_keys.host_names import Address, with_local
from giraff_node.network.key_bundle import BACKDATED

PROGRAM_MADE: Final = datetime(2026, 1, 1, tzinfo=UTC)  # no clock that is right is before it
AUTHORITY_LIFE: Final = timedelta(days=3652)  # ten years


class CertificateError(Exception):
    """No certificate can be made like this."""


@dataclass(frozen=True)
class Identity:
    """A certificate and its private key."""

    certificate: x509.Certificate
    key: EllipticCurvePrivateKey

    @property
    def certificate_pem(self) -> bytes:
        return self.certificate.public_bytes(serialization.Encoding.PEM)

    @property
    def key_pem(self) -> bytes:
        """Without a passphrase: nobody is there to type it when a robot starts."""
        return self.key.private_bytes(
            serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
        )


def new_authority(now: datetime) -> Identity:
    """A CA that signs hosts, and no further CAs."""
    key = generate_private_key(SECP256R1())
    # Verifiers look for a signer by its name: two CAs made on one day must not be taken for each other.
    name = _name(f"Giraff CA {now:%Y-%m-%d} {x509.random_serial_number() & 0xFFFF_FFFF:08x}")
    builder = _builder(key, now, now + AUTHORITY_LIFE).subject_name(name).issuer_name(name)
    builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    builder = builder.add_extension(_key_usage(signs=True), critical=True)
    return Identity(builder.sign(key, hashes.SHA256()), key)


def new_host(authority: Identity, name: str, addresses: Sequence[Address], now: datetime, days: int) -> Identity:
    """By which a host shows its name, to those it calls and to those who call it. Raises CertificateError."""
    ends = now + timedelta(days=days)
    _require_outlived_by(authority.certificate, now, ends)
    key = generate_private_key(SECP256R1())
    both_ways = [ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH]
    extensions: tuple[tuple[x509.ExtensionType, bool], ...] = (
        (x509.BasicConstraints(ca=False, path_length=None), True),
        (_key_usage(signs=False), True),
        (x509.ExtendedKeyUsage(both_ways), False),
        (x509.SubjectAlternativeName([_general_name(address) for address in with_local(addresses)]), False),
        (x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key()), False),
    )
    builder = _builder(key, now, ends).subject_name(_name(name)).issuer_name(authority.certificate.subject)
    for extension, critical in extensions:
        builder = builder.add_extension(extension, critical=critical)
    return Identity(builder.sign(authority.key, hashes.SHA256()), key)


def common_name(certificate: x509.Certificate) -> str:
    """Who it says it is, which is what access rules go by; empty when it does not say."""
    return "".join(str(part.value) for part in certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME))


def addresses_of(certificate: x509.Certificate) -> tuple[Address, ...]:
    """Where it may be met, the host's own included."""
    try:
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return ()
    values = (general.value for general in names if isinstance(general, x509.IPAddress | x509.DNSName))
    return tuple(value for value in values if isinstance(value, Address))


def _require_outlived_by(authority: x509.Certificate, now: datetime, ends: datetime) -> None:
    first, last = authority.not_valid_before_utc, authority.not_valid_after_utc
    if now < first:
        raise CertificateError(
            f"the CA is valid from {first:%Y-%m-%d}, and this machine's clock says {now:%Y-%m-%d}: set the clock"
        )
    if now >= last:
        raise CertificateError(
            f"the CA expired on {last:%Y-%m-%d}, and this machine's clock says {now:%Y-%m-%d}: if the clock is right, "
            "make a new CA in another folder, and from it new bundles for all hosts"
        )
    if ends > last:
        raise CertificateError(
            f"the CA ends on {last:%Y-%m-%d}, and what it signs must end before: --days {(last - now).days} at most, "
            "or a new CA in another folder, and from it new bundles for all hosts"
        )


def _builder(key: EllipticCurvePrivateKey, now: datetime, ends: datetime) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - BACKDATED)
        .not_valid_after(ends)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
    )


def _name(text: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])


def _general_name(address: Address) -> x509.GeneralName:
    return x509.DNSName(address) if isinstance(address, str) else x509.IPAddress(address)


def _key_usage(*, signs: bool) -> x509.KeyUsage:
    """A CA signs certificates, a host the handshakes of TLS; neither is for anything else."""
    return x509.KeyUsage(
        digital_signature=not signs,
        key_cert_sign=signs,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        crl_sign=False,
        encipher_only=False,
        decipher_only=False,
    )
