"""What a flood of the door does to a robot that drives, and to who wants to stop it. No Docker.

docs/network.md has the figures of more floods than are made here.
"""

import contextlib
import datetime as dt
import json
import re
import resource
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from giraff_core.network import door_ports
from giraff_setup.keys.manage import make_authority, make_bundle
from giraff_sim.board import ROOT
from tests.hosts.process_site import INSIDE, NUMBERS, PYTHON, ProcessSite
from tests.hosts.switch import NETWORK
from tests.support.process_robot import FULL_TILT
from tests.support.waiting import wait

pytestmark = pytest.mark.timeout(120)

ROBOT: Final = f"{NETWORK}.{NUMBERS['robot']}"
ALL_PORTS: Final = [address.rpartition(":")[2] for address in door_ports(f"{ROBOT}:7447")]
ACCESS: Final = '{ robot = ["robot"], operators = { laptop = ["joystick"] } }'
SERVICES: Final = ("door", *INSIDE)
[MOST_FILES] = (
    int(number)
    for number in re.findall(
        r"LimitNOFILE=(\d+)", (ROOT / "deploy/systemd/giraff@.service").read_text(encoding="utf-8")
    )
)
_WINDOW: Final = 3.0  # s
_LEAVE: Final = 12
"""Peers that leave in order, and as many that are killed."""
_STAY: Final = 3  # s of each
_MORE_FILES: Final = 3
_MORE_MEMORY: Final = 4.0  # MB
_PATIENCE: Final = 60.0  # s


@pytest.fixture
def site(tmp_path: Path) -> Iterator[ProcessSite]:
    with ProcessSite(tmp_path) as site:
        yield site


@pytest.mark.parametrize(
    ("kind", "ports", "bounded"),
    [("half-open", ALL_PORTS[:1], False), ("garbage", ALL_PORTS, True)],
    ids=["one port", "all ports, with the rules"],
)
def test_a_robot_drives_on_and_can_be_stopped(site: ProcessSite, kind: str, ports: list[str], *, bounded: bool) -> None:
    """Without the rules the second flood keeps every stop out that is not yet linked."""
    robot, laptop = secured(site)
    if bounded:
        site.bound("robot")
    site.start(robot, *SERVICES)
    resource.prlimit(site.pid("door"), resource.RLIMIT_NOFILE, (MOST_FILES, MOST_FILES))
    site.start(laptop, "joystick", host="laptop")
    turn(site)
    before = numbers(site)
    flood(site, kind, *ports)
    wait(lambda: told(site)["made"] >= (5 if bounded else 5000), _PATIENCE, what=lambda: told(site))
    wait(lambda: turns_on(site), _PATIENCE, what="driving without a gap")
    assert "STOPPED" in site.giraff("laptop", laptop, "estop", "engage", "--timeout", "5")
    wait(lambda: not site.hardware.drives(), _PATIENCE)
    assert numbers(site) == before
    assert "starting again" not in site.log("door")


def test_peers_that_come_and_go_leave_nothing_behind(site: ProcessSite) -> None:
    """Base, guard and the others dial each of them."""
    site.start({}, *SERVICES)
    site.start({}, "joystick", host="laptop")
    turn(site)
    pids = numbers(site)
    peers = flood(site, "peers", *ALL_PORTS[:1])
    wait(lambda: min(links_to_strangers(site)) >= 20, _PATIENCE, what=lambda: links_to_strangers(site))
    wait(lambda: turns_on(site), _PATIENCE, what="driving without a gap")
    wait(lambda: peers.poll() is not None, _PATIENCE)
    wait(lambda: not any(links_to_strangers(site)), _PATIENCE, what=lambda: links_to_strangers(site))
    assert numbers(site) == pids


def test_peers_that_leave_one_by_one_leave_nothing_behind(site: ProcessSite) -> None:
    """While another of their host stays. Each was missed, and each visit for it left links in all services."""
    services = (*SERVICES, "motion", "joystick")
    site.start({}, *SERVICES, "motion")
    site.start({}, "joystick", host="laptop")
    turn(site)
    flood(site, "stays", *ALL_PORTS[:1])
    wait(lambda: min(links_to_strangers(site)) >= 1, _PATIENCE, what=lambda: links_to_strangers(site))
    site.hardware.run(_WINDOW)
    before = {name: used(site.pid(name)) for name in services}
    peers: list[subprocess.Popen[bytes]] = []
    for number in range(_LEAVE + _STAY):
        if number < _LEAVE:
            flood(site, "stays", *ALL_PORTS[:1], name=f"killed-{number}")
            peers.append(flood(site, "leaves", *ALL_PORTS[:1], name=f"leaves-{number}"))
        site.hardware.run(1.0)
        if number >= _STAY:
            site.kill(f"killed-{number - _STAY}")
    wait(lambda: all(peer.poll() == 0 for peer in peers), _PATIENCE)

    def more() -> dict[str, tuple[int, float]]:
        now = {name: used(site.pid(name)) for name in services}
        return {name: (now[name][0] - files, now[name][1] - memory) for name, (files, memory) in before.items()}

    wait(lambda: all(abs(files) <= _MORE_FILES for files, _ in more().values()), _PATIENCE, what=more)
    assert max(memory for _, memory in more().values()) <= _MORE_MEMORY, more()


def secured(site: ProcessSite) -> tuple[dict[str, str], dict[str, str]]:
    """Return the network of the robot and that of the laptop."""
    folder, now = site.directory / "keys", dt.datetime.now(dt.UTC)
    make_authority(folder, now)
    for host in ("robot", "laptop"):
        make_bundle(folder, host, [f"{NETWORK}.{NUMBERS[host]}"], days=60, renew=False, moment=now)
    common = {"mode": "secured", "access": ACCESS}
    return (
        common | {"keys": str(folder / "robot")},
        common | {"keys": str(folder / "laptop"), "connect": json.dumps([ROBOT])},
    )


def turn(site: ProcessSite) -> None:
    """Drive, and then turn where it stands, which no wall ends."""
    site.hardware.drive()
    site.hardware.simulator.tilt(0.0, FULL_TILT)


def turns_on(site: ProcessSite) -> bool:
    """Whether the motors are given something in each millisecond of a while. A machine that stalls is tried again."""
    since = site.hardware.simulator.now()
    site.hardware.run(_WINDOW)
    record = site.hardware.simulator.record(since)
    is_driven = record.driven_ms >= (record.until_us - record.since_us) // 1000
    if not is_driven:
        turn(site)
    return is_driven


def flood(site: ProcessSite, kind: str, *ports: str, name: str = "flood") -> subprocess.Popen[bytes]:
    command = [*PYTHON, str(Path(__file__).with_name("flood.py")), kind, ROBOT, *ports]
    return site.begin(name, "stranger", command, {})


def told(site: ProcessSite) -> dict[str, int]:
    """Return what the flood has told last."""
    lines = site.output("flood").rpartition("\n")[0].splitlines()
    counts: dict[str, int] = json.loads(lines[-1]) if lines else {"open": 0, "made": 0}
    return counts


def numbers(site: ProcessSite) -> list[int]:
    return [site.pid(name) for name in SERVICES]


def links_to_strangers(site: ProcessSite) -> list[int]:
    """Return how many sockets each service inside has whose other end is at the stranger, by the kernel's table."""
    stranger = bytes(reversed(socket.inet_aton(f"{NETWORK}.{NUMBERS['stranger']}"))).hex().upper()
    table = [line.split() for line in Path(f"/proc/{site.pid('base')}/net/tcp").read_text("utf-8").splitlines()]
    ends = {f"socket:[{row[9]}]" for row in table if row[2].startswith(stranger)}
    return [sum(end in ends for end in descriptors(site.pid(name))) for name in INSIDE]


def used(pid: int) -> tuple[int, float]:
    """Return descriptors and memory (MB) of a process."""
    [kilobytes] = re.findall(r"RssAnon:\s+(\d+)", Path(f"/proc/{pid}/status").read_text("utf-8"))
    return sum(1 for _ in descriptors(pid)), int(kilobytes) / 1000


def descriptors(pid: int) -> Iterator[str]:
    """Yield what each descriptor of a process is."""
    for descriptor in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # closed meanwhile
            yield str(descriptor.readlink())
