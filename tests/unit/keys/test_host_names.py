"""What may stand in a certificate, and what is refused with the way out."""

import string
from ipaddress import ip_address

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_keys.host_names import LOCAL, require_address, require_name, with_local, without_local
from giraff_schemas.topics import require_chunk


@pytest.mark.parametrize("name", ["robot", "giraff-1", "Lab_2", "7", "x" * 63])
def test_a_name_is_taken_as_it_is(name: str) -> None:
    assert require_name(name) == name


@pytest.mark.parametrize(
    "name", ["", ".", "..", ".robot", "-robot", "a/b", "*", "@x", "a b", "ca.key", "robot\n", "Köln", "x" * 64]
)
def test_what_is_no_chunk_of_a_key_or_no_folder_is_no_name(name: str) -> None:
    with pytest.raises(ValueError, match="use letters, digits, '-' and '_'"):
        require_name(name)


@given(st.text(alphabet=string.printable, max_size=8))
def test_a_name_that_is_taken_is_one_chunk_of_a_key(name: str) -> None:
    try:
        taken = require_name(name)
    except ValueError:
        return
    assert require_chunk(taken) == name
    assert not set(name) & set("./@")


@pytest.mark.parametrize("text", ["192.168.1.20", "::1", "fd00::1:2", "10.0.0.0"])
def test_an_ip_address_is_one(text: str) -> None:
    assert require_address(text) == ip_address(text)


@pytest.mark.parametrize("text", ["robot", "Robot.LAN", "giraff-1.fritz.box", "1host", "xn--kln-sna.example"])
def test_a_dns_name_is_taken_in_lower_case(text: str) -> None:
    assert require_address(text) == text.lower()


@pytest.mark.parametrize(
    "text",
    [
        *("", "tls/192.168.1.20", "192.168.1.20:7447", "192.168.1.0/24", "*.lan", "192.168.1.300", "192.168.1", "1"),
        *("robot_1.lan", "-robot", "robot-.lan", "robot.lan.", "robot lan", "köln.lan", "a" * 64, "a." * 127 + "lan"),
    ],
)
def test_what_is_neither_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(ValueError, match=r"write it bare, like 192\.168\.1\.20 or robot\.lan"):
        require_address(text)


@pytest.mark.parametrize("text", ["0.0.0.0", "::", "224.0.0.224", "ff02::1"])  # noqa: S104
def test_an_address_of_no_host_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="ip -brief address"):
        require_address(text)


def test_an_interface_is_not_part_of_an_address() -> None:
    with pytest.raises(ValueError, match="behind % counts on one host only"):
        require_address("fe80::1%eth0")


def test_the_hosts_own_addresses_are_added_once() -> None:
    given_twice = [require_address(text) for text in ("10.0.0.1", "localhost", "10.0.0.1")]
    assert with_local(given_twice) == (ip_address("10.0.0.1"), "localhost", *LOCAL[:2])
    assert without_local(with_local(given_twice)) == (ip_address("10.0.0.1"),)
