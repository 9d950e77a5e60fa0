"""By which certificate browsers know this service, and when it is made anew."""

import shutil
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.x509.oid import ExtendedKeyUsageOID

from giraff_core.access import AccessConfig
from giraff_core.network import NetworkConfig
from giraff_keys.certificates import PROGRAM_MADE, addresses_of
from giraff_keys.files import read_certificate
from giraff_keys.host_names import Address
from giraff_schemas.trouble import NO_TROUBLE
from giraff_web.server.certificates import (
    FOLDER,
    CertificateProblemError,
    for_this_host,
    host_certificate,
    made_certificate,
    own_names,
)
from tests.unit.keys.folders import DAY, NOW, authority, bundle

NAMES = own_names("desk", ["10.0.0.5"], ["robot.example"])


def leaf(state: Path) -> x509.Certificate:
    return read_certificate(state / FOLDER / "host.pem")


def made(state: Path, names: tuple[Address, ...] = NAMES, now: timedelta = timedelta()) -> x509.Certificate:
    """The host's certificate after a start then."""
    _, problem = made_certificate(state, "desk", names, NOW + now)
    assert problem == NO_TROUBLE
    return leaf(state)


def test_it_is_of_all_names_and_addresses_of_this_host() -> None:
    local = (ip_address("127.0.0.1"), ip_address("::1"), "localhost")
    assert ("desk", "desk.local", ip_address("10.0.0.5"), "robot.example", *local) == NAMES
    assert own_names("a_b", [], []) == local
    assert own_names("desk.lan", [], [])[0:2] == ("desk.lan", local[0])


@pytest.mark.parametrize("name", ["https://robot.lan", "a b", "*", "robot.lan:8443", "224.0.0.1"])
def test_a_name_that_can_be_none_is_told(name: str) -> None:
    with pytest.raises(CertificateProblemError, match=r"^\[web\] names: "):
        own_names("desk", [], [name])


def test_browsers_can_take_it(tmp_path: Path) -> None:
    certificate = made(tmp_path)
    assert addresses_of(certificate) == NAMES
    usage = certificate.extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
    assert ExtendedKeyUsageOID.SERVER_AUTH in usage
    assert certificate.not_valid_after_utc - certificate.not_valid_before_utc <= timedelta(days=397)
    certificate.verify_directly_issued_by(read_certificate(tmp_path / FOLDER / "ca.pem"))


def test_the_authoritys_key_is_nowhere_and_the_hosts_readable_by_nobody_else(tmp_path: Path) -> None:
    made(tmp_path)
    files = {path.name: path.stat().st_mode & 0o777 for path in tmp_path.rglob("*") if path.is_file()}
    assert files == {"ca.pem": 0o644, "host.pem": 0o644, "host.key": 0o600}


def test_it_is_the_same_after_the_next_start_so_that_who_trusts_it_goes_on(tmp_path: Path) -> None:
    first = made(tmp_path)
    assert made(tmp_path, now=300 * DAY) == first
    assert made(tmp_path, names=NAMES[:3]) == first


@pytest.mark.parametrize(
    ("names", "now"),
    [
        ((*NAMES, ip_address("10.0.0.6")), timedelta()),
        ((*NAMES, "other.example"), timedelta()),
        (NAMES, 367 * DAY),
        (NAMES, 5000 * DAY),
    ],
)
def test_it_is_made_anew_for_other_names_and_when_it_is_over_soon(
    tmp_path: Path, names: tuple[Address, ...], now: timedelta
) -> None:
    first = made(tmp_path)
    second = made(tmp_path, names=names, now=now)
    assert second != first
    assert {*names} <= {*addresses_of(second)}


@pytest.mark.parametrize(
    ("addresses", "further", "same"),
    [
        (["10.0.0.5", "172.17.0.1"], ["robot.example"], True),
        (["172.17.0.1"], ["robot.example"], False),
        ([], ["robot.example"], True),
        (["10.0.0.5", "172.17.0.1"], ["other.example"], False),
        (["10.0.0.5", "172.17.0.1"], ["172.17.0.1"], False),
    ],
    ids=["another comes", "it has moved", "no network yet", "another name", "an address that the robot file names"],
)
def test_an_address_that_comes_beside_the_others_costs_no_devices_trust(
    tmp_path: Path, addresses: list[str], further: list[str], same: bool
) -> None:
    first = made(tmp_path)
    passing = {*addresses} - {*further}
    _, notice = made_certificate(tmp_path, "desk", own_names("desk", addresses, further), NOW, passing)
    assert (leaf(tmp_path) == first) == same
    lacks = "172.17.0.1" in addresses and same
    assert ("does not name 172.17.0.1" in str(notice)) == lacks
    assert lacks or not notice


@pytest.mark.parametrize(
    "now", [-2 * DAY, datetime(2000, 1, 1, tzinfo=UTC) - NOW, datetime(1970, 1, 1, tzinfo=UTC) - NOW]
)
def test_a_boot_without_a_clock_keeps_it_and_says_so(tmp_path: Path, now: timedelta) -> None:
    first = made(tmp_path)
    _, notice = made_certificate(tmp_path, "desk", NAMES, NOW + now)
    assert leaf(tmp_path) == first
    assert f"but at the start the clock stood at {NOW + now:%Y-%m-%d}; set the clock" in str(notice)


def test_one_that_is_made_without_a_clock_is_good_once_the_clock_is_set(tmp_path: Path) -> None:
    made_certificate(tmp_path, "desk", NAMES, datetime(1970, 1, 1, tzinfo=UTC))
    first = leaf(tmp_path)
    assert made(tmp_path, now=PROGRAM_MADE + 30 * DAY - NOW) == first


@pytest.mark.parametrize("damaged", ["host.pem", "host.key", "ca.pem"])
def test_what_is_damaged_or_gone_is_made_anew(tmp_path: Path, damaged: str) -> None:
    first = made(tmp_path)
    (tmp_path / FOLDER / damaged).write_bytes(b"nonsense")
    second = made(tmp_path)
    (tmp_path / FOLDER / damaged).unlink()
    third = made(tmp_path)
    assert len({first, second, third}) == 3


def test_one_of_another_authority_is_made_anew(tmp_path: Path) -> None:
    first, _ = made(tmp_path / "a"), made(tmp_path / "b")
    shutil.copy(tmp_path / "b" / FOLDER / "ca.pem", tmp_path / "a" / FOLDER / "ca.pem")
    assert made(tmp_path / "a") != first


def test_where_it_cannot_be_kept_there_is_one_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "state").write_text("no folder")
    got, problem = made_certificate(tmp_path / "state", "desk", NAMES, NOW)
    assert got.authority.startswith(b"-----BEGIN CERTIFICATE-----")
    assert "must trust another one after each start" in str(problem)


def test_a_secured_network_has_its_own(tmp_path: Path) -> None:
    keys = authority(tmp_path / "keys")
    network = NetworkConfig(mode="secured", keys=str(bundle(keys)), access=AccessConfig(robot=("robot",)))
    got, problem = for_this_host(network, tmp_path / "state", "desk", NAMES, NOW)
    assert (got.authority, problem) == ((keys / "ca.pem").read_bytes(), NO_TROUBLE)
    assert not (tmp_path / "state").exists()


def test_a_bundle_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(CertificateProblemError, match="copy this host's bundle there again"):
        host_certificate(tmp_path)


def test_a_key_of_another_certificate_is_told(tmp_path: Path) -> None:
    keys = authority(tmp_path / "keys")
    one, other = bundle(keys, "one"), bundle(keys, "other")
    shutil.copy(other / "host.key", one / "host.key")
    with pytest.raises(CertificateProblemError, match="certificate and key"):
        host_certificate(one)
