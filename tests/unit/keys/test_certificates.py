"""What the certificates say."""

from datetime import timedelta
from ipaddress import ip_address

import pytest
from cryptography import x509
from cryptography.hazmat.primitives.asymmetric.ec import SECP256R1
from cryptography.x509.oid import ExtendedKeyUsageOID

from giraff_keys.certificates import (
    AUTHORITY_LIFE,
    CertificateError,
    addresses_of,
    common_name,
    new_authority,
    new_host,
)
from tests.unit.keys.folders import DAY, NOW

AUTHORITY = new_authority(NOW)


def host(days: int = 730) -> x509.Certificate:
    return new_host(AUTHORITY, "robot", [ip_address("10.0.0.1"), "robot.lan"], NOW, days).certificate


def test_a_host_shows_its_name_at_its_addresses_and_its_loopback_both_ways() -> None:
    certificate = host()
    certificate.verify_directly_issued_by(AUTHORITY.certificate)
    assert common_name(certificate) == "robot"
    local = (ip_address("127.0.0.1"), ip_address("::1"), "localhost")
    assert addresses_of(certificate) == (ip_address("10.0.0.1"), "robot.lan", *local)
    extensions = certificate.extensions
    usage = extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
    assert {*usage} == {ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH}


def test_a_host_signs_handshakes_and_no_certificates() -> None:
    extensions = host().extensions
    constraints = extensions.get_extension_for_class(x509.BasicConstraints)
    usage = extensions.get_extension_for_class(x509.KeyUsage)
    assert constraints.critical
    assert usage.critical
    assert not constraints.value.ca
    assert usage.value.digital_signature
    assert not usage.value.key_cert_sign


def test_a_ca_signs_hosts_and_no_further_ca() -> None:
    constraints = AUTHORITY.certificate.extensions.get_extension_for_class(x509.BasicConstraints)
    usage = AUTHORITY.certificate.extensions.get_extension_for_class(x509.KeyUsage)
    assert constraints.critical
    assert usage.critical
    assert (constraints.value.ca, constraints.value.path_length) == (True, 0)
    assert (usage.value.key_cert_sign, usage.value.digital_signature) == (True, False)


def test_two_cas_of_one_moment_are_not_taken_for_each_other() -> None:
    other = new_authority(NOW)
    assert other.certificate.subject != AUTHORITY.certificate.subject
    with pytest.raises(ValueError, match="Issuer"):
        host().verify_directly_issued_by(other.certificate)


def test_they_count_from_a_day_before_for_clocks_that_are_behind() -> None:
    for certificate, life in ((AUTHORITY.certificate, AUTHORITY_LIFE), (host(), timedelta(days=730))):
        assert certificate.not_valid_before_utc == NOW - DAY
        assert certificate.not_valid_after_utc == NOW + life


def test_keys_are_of_their_own_and_on_the_curve_p256() -> None:
    first, second = (new_host(AUTHORITY, "robot", [], NOW, 1) for _ in range(2))
    assert isinstance(first.key.curve, SECP256R1)
    assert first.key.public_key() != second.key.public_key()
    assert first.certificate.serial_number != second.certificate.serial_number
    assert first.key_pem.startswith(b"-----BEGIN PRIVATE KEY-----")


def test_nothing_outlives_its_ca() -> None:
    year_before = NOW + AUTHORITY_LIFE - 365 * DAY
    new_host(AUTHORITY, "robot", [], year_before, 365)
    with pytest.raises(CertificateError, match="--days 365 at most, or a new CA"):
        new_host(AUTHORITY, "robot", [], year_before, 366)
    with pytest.raises(
        CertificateError, match="the CA expired on 2036-11-20, and this machine's clock says 2036-11-20"
    ):
        new_host(AUTHORITY, "robot", [], NOW + AUTHORITY_LIFE, 1)


def test_a_clock_before_the_ca_was_made_is_named() -> None:
    with pytest.raises(
        CertificateError, match="from 2026-11-20, and this machine's clock says 2026-11-19: set the clock"
    ):
        new_host(AUTHORITY, "robot", [], NOW - 2 * DAY, 1)
