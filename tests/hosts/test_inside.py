"""What another host may do to a robot whose base, guard and ranger listen to their own host alone. No Docker.

The simulator's record of the motors is the judge.
"""

import datetime as dt
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import pytest

from giraff_node.network.session import certificates
from giraff_setup.keys.manage import make_authority, make_bundle
from tests.hosts.process_site import INSIDE, NAME, NUMBERS, PYTHON, ProcessSite
from tests.hosts.switch import NETWORK
from tests.support.keyboard_user import take
from tests.support.process_robot import FULL_TILT
from tests.support.terminals import screen
from tests.support.waiting import wait

pytestmark = pytest.mark.timeout(120)

ROBOT: Final = f"{NETWORK}.{NUMBERS['robot']}"
HOSTS: Final = {"robot": "robot", "joystick": "laptop", "viewer": "laptop"}
"""Certificate -> where its host is."""
ACCESS: Final = '{ robot = ["robot"], viewers = ["viewer"], operators = { joystick = ["joystick"] } }'
GOES_THROUGH: Final = "all goes through the"
SAID: Final = 30
"""Samples, some seconds of them, that an impostor of any service says in a test."""
_PATIENCE: Final = 60.0  # s
_SCRIPT: Final = f"""
import time
from giraff_client import Robot
with Robot({NAME!r}, connect={{connect}}) as robot:
    until = time.monotonic() + 1.0
    while time.monotonic() < until:
        robot.drive(0.3, 0.0)
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessSite]:
    with ProcessSite(tmp_path_factory.mktemp("site")) as site:
        yield site


@pytest.fixture
def site(made: ProcessSite) -> Iterator[ProcessSite]:
    """Hosts on which nothing runs; the hand is level."""
    made.hardware.simulator.tilt(0.0, 0.0)
    yield made
    made.kill()
    made.open("laptop")


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder, now = tmp_path_factory.mktemp("authority") / "keys", dt.datetime.now(dt.UTC)
    make_authority(folder, now)
    for name, host in HOSTS.items():
        make_bundle(folder, name, [f"{NETWORK}.{NUMBERS[host]}"], days=60, renew=False, moment=now)
    return folder


@pytest.mark.parametrize("mode", ["lan", "fixed"])
def test_a_laptop_that_nobody_can_dial_does_all_through_the_door(site: ProcessSite, mode: str) -> None:
    """Its firewall lets nothing in; in `lan` only answers to what it calls by multicast, which no firewall tells from
    what a stranger sends.
    """
    network = {"mode": mode}
    connect = [ROBOT] if mode == "fixed" else []
    named = [word for address in connect for word in ("--connect", address)]
    site.start(network, "door", *INSIDE)
    wait(lambda: site.log("door"), _PATIENCE, what="a door that listens")
    site.shut("laptop", but="meta l4proto udp" if mode == "lan" else "")

    drive = site.machines["laptop"].inside([*PYTHON, "-m", "giraff_cli", "drive", "--robot", NAME, *named])
    environment = site.environment(network) | {"GIRAFF_CONFIG": "/dev/null", "TERM": "xterm"}
    with screen(drive, site.directory / "drive.log", environment) as shown:
        shown.wait_for("nobody's: press an arrow", _PATIENCE)
        take(shown)

        def drives() -> bool:
            shown.type(b"w")
            return site.hardware.drives()

        wait(drives, _PATIENCE, what="a key that drives", every=1 / 30)
        assert "STOPPED" in site.giraff("laptop", network, "estop", "engage", *named)
        wait(lambda: not site.hardware.drives(), _PATIENCE)
    assert site.log("drive").count(GOES_THROUGH) == 1

    site.giraff("laptop", network, "estop", "reset", *named)
    assert '"base":{"age"' in site.giraff("laptop", network, "watch", "--for", "0.5", "--json", *named)
    assert " 0 lost" in site.giraff("laptop", network, "record", "--for", "0.5", *named)
    since = site.hardware.simulator.now()
    told = site.run("laptop", network, ["-c", _SCRIPT.format(connect=connect)])
    assert site.hardware.last_driven(since) is not None
    assert told.count(GOES_THROUGH) == 1
    site.start(network | ({"connect": json.dumps(connect)} if connect else {}), "joystick", host="laptop")
    site.hardware.drive()
    assert site.log("joystick").count(GOES_THROUGH) == 1


@pytest.mark.parametrize(
    ("mode", "dead"), [("lan", ("guard", "ranger", "base")), ("fixed", ("guard",)), ("secured", ("guard", "ranger"))]
)
def test_a_program_elsewhere_speaks_for_no_dead_service(
    site: ProcessSite, mode: str, dead: tuple[str, ...], keys: Path
) -> None:
    """As a peer to which all of them link and as a client of the door; with every certificate but the robot's."""
    network = {"mode": mode}
    links: list[dict[str, Any]] = [{"protocols": ["tcp"]}]
    if mode == "secured":
        network |= {"keys": str(keys / "robot"), "access": ACCESS}
        bundles = (certificates(keys / name) for name in ("joystick", "viewer"))
        links = [{"protocols": ["tls"], "tls": bundle | {"enable_mtls": True}} for bundle in bundles]
    hardware, simulator = site.hardware, site.hardware.simulator
    site.start(network, "door", *INSIDE, "joystick")
    hardware.drive()
    configs = [json.dumps(session(kind, link, mode)) for link in links for kind in ("peer", "client")]
    impostor = site.begin(
        "impostor", "laptop", [*PYTHON, str(Path(__file__).with_name("impostor.py")), NAME, *configs], {}
    )

    def told() -> dict[str, Any]:
        lines = site.output("impostor").rpartition("\n")[0].splitlines()
        said: dict[str, Any] = json.loads(lines[-1]) if lines else {"heard": {}, "links": [0], "said": 0}
        return said

    def speak_for(service: str) -> None:
        assert impostor.stdin is not None
        impostor.stdin.write(f"{service}\n".encode())
        impostor.stdin.flush()

    def is_ready() -> bool:
        says = told()
        linked = all(count >= (len(INSIDE) if place % 2 == 0 else 1) for place, count in enumerate(says["links"]))
        return linked and {"tick", "wheels", "cmd_vel", "range/rear"} <= says["heard"].keys()

    for service in dead:
        simulator.tilt(0.0, 0.0)
        wait(is_ready, _PATIENCE, what=told)
        site.kill(service)
        hardware.run(0.6)
        since, said = simulator.now(), told()["said"]
        speak_for(service)
        hardware.run(2.0)  # where it is believed, the level hand arms
        if service == "ranger":
            simulator.tilt(FULL_TILT, 0.0)
            hardware.run(1.0)
        assert told()["said"] - said >= SAID
        assert hardware.last_driven(since) is None, service
        if service != "base":
            speak_for("")
        site.start(network, service)
        hardware.drive()  # beside who speaks for base, too
        speak_for("")


def session(kind: str, link: dict[str, Any], mode: str) -> dict[str, Any]:
    """As any program with Zenoh opens one."""
    [protocol] = link["protocols"]
    return {
        "mode": kind,
        "connect": {"endpoints": [f"{protocol}/{ROBOT}:7447"]},
        "listen": {"endpoints": [f"{protocol}/0.0.0.0:0"] if kind == "peer" else []},
        "scouting": {"multicast": {"enabled": mode == "lan"}},
        "transport": {"link": link},
    }
