"""The same hosts on networks without multicast, then with certificates, and a stranger's host on their switch."""

from __future__ import annotations

import datetime as dt
import json
import os
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

import pytest

from giraff_cli.keys import make_authority, make_bundle
from giraff_node.access import AccessConfig
from giraff_node.key_bundle import BACKDATED
from giraff_node.session import NetworkConfig, session_config
from tests.hosts.clone import clone
from tests.hosts.lab import NAME, NUMBERS, Lab, address
from tests.hosts.machine import Machine
from tests.hosts.switch import NETWORK
from tests.support.waiting import wait

Figure = Callable[[str, float, float, str], None]

pytestmark = pytest.mark.timeout(600)

STRANGER: Final = Path(__file__).with_name("stranger.py")
NUMBER: Final = 14
HERE: Final = f"{NETWORK}.{NUMBER}"
TRIES_FOR: Final = 5.0  # s
CALLED_WITHIN: Final = 10.0  # s; who has looked around for a while does so again every 8 s
ORDERS: Final = [("desk", "laptop", "robot"), ("robot", "laptop", "desk")]
DAYS: Final = 400
CONTAINERS_USER: Final = 1000
ACCESS: Final = """
[network.access]
robot = ["robot"]
viewers = ["desk"]
operators = { laptop = ["joystick"] }
"""
RIGHTS: Final = tomllib.loads(ACCESS)["network"]["access"]


class Tried(NamedTuple):
    """What became of a stranger's attempt."""

    heard: int
    links: list[str]
    """Locators of their other ends."""


@pytest.fixture(scope="module")
def stranger(lab: Lab) -> Iterator[Machine]:
    """A host on the same switch, which nobody has asked in."""
    machine = Machine("stranger", lab.directory / "stranger")
    machine.power_on()
    lab.switch.plug(machine, NUMBER)
    yield machine
    lab.switch.unplug(machine)
    machine.power_off()


@pytest.fixture(scope="module")
def keys(lab: Lab) -> Path:
    """The technician's folder."""
    folder = lab.directory / "keys"
    technician("keys", "init", "--folder", str(folder))
    for host in NUMBERS:
        technician("keys", "host", host, address(host), "--folder", str(folder))
    return folder


@pytest.fixture(scope="module")
def secured(lab: Lab, keys: Path) -> Iterator[None]:
    """All three are up with their certificates."""
    lab.down(*NUMBERS)
    lab.do_without_multicast("secured", profiles="robot,sentry")
    for host in NUMBERS:
        here = lab.clone(host) / "deploy"
        technician_copies(keys / host, here / "keys")
        with (here / "robot.toml").open("a") as robot_file:
            robot_file.write(ACCESS)
    lab.on_each(NUMBERS, lab.up)
    lab.wait_until_healthy(*NUMBERS)
    lab.reset_emergency_stop()
    yield
    lab.down(*NUMBERS)
    for host in NUMBERS:
        clone(lab.clone(host))


def technician(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "giraff_cli", *words], check=True, capture_output=True)


def technician_copies(bundle: Path, place: Path) -> None:
    """As docs/keys.md has it for containers."""
    place.mkdir()
    for file in bundle.iterdir():
        copy = place / file.name
        copy.write_bytes(file.read_bytes())
        copy.chmod(0o600)
        os.chown(copy, CONTAINERS_USER, CONTAINERS_USER)


def tried(machine: Machine, config: dict[str, Any], seconds: float = TRIES_FOR) -> Tried:
    command = [sys.executable, str(STRANGER), NAME, json.dumps(config), str(seconds)]
    with machine.start(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        output, errors = process.communicate(timeout=60.0)
    assert process.returncode == 0, errors.decode()
    return Tried(**json.loads(output))


def as_a_home_has_it() -> dict[str, Any]:
    return session_config(NetworkConfig(), NAME, visiting=True)


def waiting_to_be_called() -> dict[str, Any]:
    """As a home has it, but that it calls nobody."""
    config = as_a_home_has_it()
    config["connect"]["endpoints"] = []
    for way in ("multicast", "gossip"):
        config["scouting"].setdefault(way, {})["autoconnect"] = {"peer": []}
    return config


def with_keys(bundle: Path) -> dict[str, Any]:
    """As the robot's own hosts have it, with rules that hold back nothing of one's own."""
    network = NetworkConfig(
        mode="secured", connect=(address("robot"),), keys=str(bundle), access=AccessConfig(robot=("robot",))
    )
    config = session_config(network, NAME, visiting=True)
    config["access_control"] = {"enabled": False}
    return config


def without_certificate(keys: Path) -> dict[str, Any]:
    config = with_keys(keys / "desk")
    config["transport"]["link"]["tls"] = {"root_ca_certificate": str(keys / "ca.pem")}
    config["listen"]["endpoints"] = []
    return config


def anothers(lab: Lab) -> Path:
    """A bundle for the robot's name and address, of another authority."""
    folder, now = lab.directory / "another authority", dt.datetime.now(dt.UTC)
    make_authority(folder, now)
    make_bundle(folder, "robot", [address("robot")], days=DAYS, renew=False, moment=now)
    return folder / "robot"


def expired(keys: Path) -> Path:
    """A bundle of the robot's own authority that ended a second after that was made: no bundle begins earlier."""
    made = dt.datetime.fromtimestamp((keys / "ca.pem").stat().st_mtime, dt.UTC)
    first = made - BACKDATED + dt.timedelta(seconds=1)
    make_bundle(keys, "old", [address("robot")], days=1, renew=False, moment=first)
    return keys / "old"


def test_an_open_network_is_open(lab: Lab, stranger: Machine) -> None:
    """What the others are held against: it hears the robot, and the robot calls it."""
    lab.down(*NUMBERS)
    for host in NUMBERS:
        lab.write_env(host)
    lab.on_each(NUMBERS, lab.up)
    lab.wait_until_healthy(*NUMBERS)
    lab.reset_emergency_stop()
    lab.switch.count_calls(lab.machines["robot"], HERE)
    assert tried(stranger, as_a_home_has_it()).heard > 100
    # One that calls nobody: else it may be the first to call, and nobody calls twice.
    attempt = tried(stranger, waiting_to_be_called(), CALLED_WITHIN)
    assert attempt.heard > 100
    assert attempt.links
    assert lab.switch.calls() > 0


@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_up_one_after_another_without_multicast(lab: Lab, order: tuple[str, ...], figure: Figure) -> None:
    lab.down(*NUMBERS)
    lab.do_without_multicast("fixed")
    last = 0.0
    for host in order:
        last = lab.up(host)
        time.sleep(1.0)
    network = {"mode": "fixed", "connect": [address("robot")]}
    with lab.listen("desk", "odom", network=network) as desk:
        wait(lambda: bool(desk.heard()), 30.0, what="odometry on the desk")
        lab.hardware.drive()
        figure(f"up as {', '.join(order)}, without multicast -> driven", time.monotonic() - last, 20.0, "s")


def test_driven_with_certificates(lab: Lab, secured: None, figure: Figure) -> None:  # noqa: ARG001
    figure("with certificates: level hand, then a tilt -> wheels turn", lab.hardware.drive(), 10.0, "s")


@pytest.mark.parametrize("seconds", [1.0, 5.0])
def test_a_cut_cable_with_certificates(lab: Lab, secured: None, keys: Path, seconds: float, figure: Figure) -> None:  # noqa: ARG001
    network = {"mode": "secured", "connect": [address("robot")], "keys": str(keys / "laptop"), "access": RIGHTS}
    with lab.listen("laptop", "odom", network=network) as laptop:
        wait(lambda: bool(laptop.heard()), 10.0, what="odometry on the laptop")
        lab.hardware.drive()
        lab.switch.cut(lab.machines["laptop"])
        time.sleep(seconds)
        lab.switch.join(lab.machines["laptop"])
        flows = laptop.flows_after(time.monotonic(), 20.0)
    figure(f"with certificates: cable back after {seconds:g} s -> samples flow", flows, 2.0, "s")
    lab.hardware.drive()


@pytest.mark.parametrize("kind", ["no certificate", "another authority", "expired", "plain tcp", "multicast"])
def test_a_stranger_is_nobody(lab: Lab, secured: None, stranger: Machine, keys: Path, kind: str) -> None:  # noqa: ARG001
    config = {
        "no certificate": lambda: without_certificate(keys),
        "another authority": lambda: with_keys(anothers(lab)),
        "expired": lambda: with_keys(expired(keys)),
        "plain tcp": lambda: session_config(NetworkConfig(mode="fixed", connect=(address("robot"),)), NAME),
        "multicast": as_a_home_has_it,
    }[kind]()
    lab.hardware.simulator.tilt(0.0, 0.0)  # armed, and at rest
    time.sleep(1.0)
    began_us = lab.hardware.simulator.now()
    lab.switch.count_calls(lab.machines["robot"], HERE)
    assert tried(stranger, config) == Tried(heard=0, links=[])
    assert lab.switch.calls() == 0, "the robot has called the stranger"
    assert lab.hardware.last_driven(began_us) is None
    lab.hardware.drive()


@pytest.mark.parametrize(("host", "refused"), [("desk", "cmd_vel/joystick"), ("laptop", "cmd_vel/keyboard")])
def test_who_is_known_does_no_more_than_it_may(
    lab: Lab,
    secured: None,  # noqa: ARG001
    keys: Path,
    host: str,
    refused: str,
) -> None:
    lab.hardware.simulator.tilt(0.0, 0.0)
    time.sleep(1.0)
    began_us = lab.hardware.simulator.now()
    attempt = tried(lab.machines[host], with_keys(keys / host))
    assert attempt.heard > 100, "it may read"
    assert lab.hardware.last_driven(began_us) is None
    wait(
        lambda: all(said(lab, f"refused {host}", f"put on giraff/{NAME}/{key};") for key in (refused, "cmd_vel")),
        20.0,
        what=f"{host} in the robot's log",
        every=1.0,
    )
    lab.hardware.drive()


def said(lab: Lab, *words: str) -> bool:
    """Whether a line of the sentry has them all."""
    lines = lab.compose("robot", "logs", "--no-color", "sentry").splitlines()
    return any(all(word in line for word in words) for line in lines)
