"""What doctor says of a machine that has IPv6 addresses alone."""

from pathlib import Path

import pytest

from giraff_cli.doctor.findings import findings
from giraff_cli.doctor.inspection import Inspection, Machine, Network
from giraff_tools.network import interfaces
from giraff_tools.network.interfaces import Interface, ipv6_alone

LISTED = """fd000000000000000000000000000002 02 40 00 80     eth0
00000000000000000000000000000001 01 80 10 80       lo
"""


@pytest.mark.parametrize(
    ("own", "up", "alone"),
    [((), "eth0", ("eth0",)), (("eth0",), "eth0", ()), ((), "none: the cable is out", ())],
)
def test_an_interface_of_ipv6_alone_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, own: tuple[str, ...], up: str, alone: tuple[str, ...]
) -> None:
    monkeypatch.setattr(interfaces, "flags_up", lambda _, name: int(name == up))
    (tmp_path / "listed").write_text(LISTED)
    known = tuple(Interface(name=name, address="10.1.1.2/24", multicast=True) for name in own)
    assert ipv6_alone(known, tmp_path / "listed") == alone
    assert ipv6_alone(known, tmp_path / "missing") == ()


def test_doctor_says_that_robots_need_ipv4() -> None:
    machine = Machine(host="pc", version="1", ipv6_alone=("eth0",))
    told = findings(Inspection(machine=machine, network=Network()))
    assert [each.what for each in told] == [
        "no robot is heard: this machine has IPv6 addresses alone (eth0), and robots listen at IPv4 alone"
    ]
    assert "dev eth0" in told[0].fix
