"""Certificates and keys in their files: what is called how, and reading them with the likely cause of each trouble."""

from pathlib import Path
from typing import Final

from cryptography import x509
from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey
from cryptography.hazmat.primitives.serialization import load_pem_private_key

from giraff_keys.certificates import Identity
from giraff_node.network.key_bundle import CA_CERTIFICATE

CA_KEY: Final = "ca.key"


class KeyFileError(Exception):
    """A file does not hold what it should; the text names it."""


def read_certificate(path: Path) -> x509.Certificate:
    """The certificate in a PEM file. Raises KeyFileError."""
    try:
        certificate = x509.load_pem_x509_certificate(_read(path))
        certificate.public_key()  # this and the extensions are parsed only when asked for
        certificate.extensions  # noqa: B018
    except (ValueError, UnsupportedAlgorithm, x509.InvalidVersion, x509.DuplicateExtension) as error:
        raise KeyFileError(f"{path} is damaged, or no certificate in PEM") from error
    return certificate


def read_key(path: Path) -> EllipticCurvePrivateKey:
    """The private key in a PEM file. Raises KeyFileError."""
    try:
        key = load_pem_private_key(_read(path), password=None)
    except TypeError as error:
        raise KeyFileError(f"{path} has a passphrase: keys are kept without one") from error
    except (ValueError, UnsupportedAlgorithm) as error:
        raise KeyFileError(f"{path} is damaged, or no private key in PEM") from error
    if not isinstance(key, EllipticCurvePrivateKey):
        raise KeyFileError(f"{path} is not a key that `giraff keys` made")
    return key


def read_authority(folder: Path) -> Identity:
    """The CA of this folder, able to sign. Raises KeyFileError."""
    certificate = read_certificate(folder / CA_CERTIFICATE)
    if not (folder / CA_KEY).exists():
        raise KeyFileError(f"{folder / CA_KEY} is not here, and only it can sign: put it back from where it is kept")
    authority = Identity(certificate, read_key(folder / CA_KEY))
    if not is_pair(certificate, authority.key):
        raise KeyFileError(
            f"{folder / CA_KEY} is not the key of {folder / CA_CERTIFICATE}: one of them is of another CA"
        )
    return authority


def is_pair(certificate: x509.Certificate, key: EllipticCurvePrivateKey) -> bool:
    """Whether the key is the certificate's."""
    return certificate.public_key() == key.public_key()


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise KeyFileError(f"{path} cannot be read: {error.strerror}") from error
