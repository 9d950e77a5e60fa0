"""A robot with several networks is found and stopped on the one that it shares with the laptop, whichever came first.

No Docker. The simulator's record of the motors is the judge.
"""

from pathlib import Path
from typing import Final, NamedTuple

import pytest

from tests.hosts.process_site import NUMBERS, PYTHON, ProcessSite
from tests.hosts.switch import NETWORK
from tests.support.process_robot import FULL_TILT
from tests.support.waiting import wait

pytestmark = pytest.mark.timeout(180)

LAN: Final = {"mode": "lan"}
_FOUND_WITHIN: Final = "40"  # s


def _network(name: str, number: int) -> tuple[str, ...]:
    """A network beside ours: of a laser scanner on a cable, or of a VPN."""
    return (
        f"link add {name} type veth peer name {name}-end",
        f"address add 192.168.{number}.1/24 dev {name}",
        f"link set {name} up",
        f"link set {name}-end up",
    )


_OTHER: Final = _network("laser", 77)
_OURS, _ANOTHER = f"{NETWORK}.{NUMBERS['robot']}/24", f"{NETWORK}.77/24"
_HAS, _HAS_NOT = f"address add {_OURS} dev eth0", f"address del {_OURS} dev eth0"


class Change(NamedTuple):
    """What happens to the robot's network before its services start, and while they run."""

    before: tuple[str, ...]
    then: tuple[str, ...]


CHANGES: Final = {
    "the laser's network is there first": Change((*_OTHER, _HAS_NOT), (_HAS,)),
    "it comes later, as a VPN does": Change(("link del laser",), _OTHER),
    "the robot's address becomes another": Change((), (_HAS_NOT, f"address add {_ANOTHER} dev eth0")),
    "its address moves to a bridge": Change(
        (f"address del {_ANOTHER} dev eth0", _HAS),
        (
            "link add br0 type bridge",
            "link set br0 up",
            _HAS_NOT,
            "link set eth0 master br0",
            f"address add {_OURS} dev br0",
        ),
    ),
}
"""Each begins where the one before ended."""


def test_a_robot_with_several_networks_is_found_and_stopped(tmp_path: Path) -> None:
    with ProcessSite(tmp_path) as site:
        for what, (before, then) in CHANGES.items():
            site.ip("robot", *before)
            site.start(LAN, "door", "base")
            wait(lambda: "recovered: board" in site.log("base"), 60.0, what=what)
            site.ip("robot", *then)
            stopped = site.giraff("laptop", LAN, "estop", "engage", "--timeout", _FOUND_WITHIN)
            assert "STOPPED" in stopped, what
            assert "starting again" not in site.log("base"), what
            site.kill()


def test_a_robot_of_a_run_is_found_and_stopped_once_its_network_comes(tmp_path: Path) -> None:
    command = ["env", f"TMPDIR={tmp_path}", *PYTHON, "-m", "giraff_cli", "run", "--boards", "host", "--hand", "none"]
    with ProcessSite(tmp_path) as site:
        site.ip("robot", *_OTHER, _HAS_NOT)
        site.begin("run", "robot", command, LAN)
        wait(lambda: site.output("run").count(" | base ") > 2, 60.0, what="a robot that runs")
        site.ip("robot", _HAS)
        assert "STOPPED" in site.giraff("laptop", LAN, "estop", "engage", "--timeout", _FOUND_WITHIN)
        logs = tmp_path.glob("giraff-run-*/*.log")
        assert [log.name for log in logs if "starting again" in log.read_text()] == ["door.log"]


def test_a_vpn_that_comes_stops_no_drive(tmp_path: Path) -> None:
    with ProcessSite(tmp_path) as site:
        site.start(LAN, "door", "base", "guard", "ranger")
        site.start(LAN, "joystick", host="laptop")
        # A machine that pauses ends a drive, too, but hardly five of six. A door that stops drives ends all of them.
        gone_on = 0
        for number in range(77, 83):
            gone_on += _drives_on(site, number)
            if gone_on == 2:
                return
        raise AssertionError("".join(site.log(service) for service in ("guard", "base", "joystick")))


def _drives_on(site: ProcessSite, number: int) -> bool:
    """Whether a drive goes on while a network comes and the door starts itself again."""
    site.hardware.drive()
    site.hardware.simulator.tilt(0.0, FULL_TILT)  # it turns where it stands, which no wall ends
    since = site.hardware.simulator.now()
    before = site.log("door").count("starting again")
    site.ip("robot", *_network(f"vpn{number}", number))
    site.hardware.run(4.0)
    assert site.log("door").count("starting again") > before
    # After a stop it would drive no more: its hand has not been level since.
    return site.hardware.drives() and site.hardware.simulator.record(since).driven_ms >= 3500
