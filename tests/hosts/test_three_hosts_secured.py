"""Strangers on the switch of three hosts: an open network lets them in; with certificates they are nobody."""

import datetime as dt
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

import pytest

from giraff_core.access import AccessConfig
from giraff_core.network import NetworkConfig, link_of
from giraff_node.network.key_bundle import BACKDATED
from giraff_node.network.session import Role, session_config
from giraff_setup.keys.manage import make_authority, make_bundle
from tests.hosts.attempts import Attempt, Told
from tests.hosts.images import CURRENT_COMPOSE
from tests.hosts.lab import NAME, NUMBERS, PATIENCE, Lab, address
from tests.hosts.machine import COMPOSE, Machine
from tests.hosts.secured import make_keys, secure
from tests.hosts.switch import NETWORK
from tests.support.waiting import wait

pytestmark = pytest.mark.timeout(600)

KINDS: Final = {"no-certificate": 14, "another-authority": 15, "expired": 16, "plain-tcp": 17, "multicast": 18}
"""Kind of stranger, each with a host of its own -> the end of its address."""
HEARD: Final = 100
"""Samples: who hears so many has no fault that keeps a stranger from hearing one."""
DAYS: Final = 400


@pytest.fixture(scope="module")
def strangers(lab: Lab) -> Iterator[dict[str, Machine]]:
    """Hosts on the same switch, which nobody has asked in."""
    machines = {kind: Machine(f"stranger{end}", lab.directory / kind) for kind, end in KINDS.items()}
    with ExitStack() as stack:
        for kind, machine in machines.items():
            machine.power_on()
            stack.callback(machine.power_off)
            lab.switch.plug(machine, KINDS[kind])
            stack.callback(lab.switch.unplug, machine)
        yield machines


@pytest.fixture(scope="module")
def keys(lab: Lab) -> Path:
    """The technician's folder."""
    return make_keys(lab)


@pytest.fixture(scope="module")
def secured(lab: Lab, up: None, keys: Path) -> None:  # noqa: ARG001  it was released there
    """All are up with their certificates: laptop and desk by docker-compose 1.29, the robot by today's Compose.

    They stay so until the lab's end: this file is the last.
    """
    lab.down(*NUMBERS)
    secure(lab, keys)
    program: dict[str, str | Path] = {"laptop": COMPOSE, "desk": COMPOSE, "robot": CURRENT_COMPOSE}
    lab.on_each(NUMBERS, lambda host: lab.up(host, program[host]))
    lab.wait_until_healthy(*NUMBERS)


def bare(network: NetworkConfig, role: Role = "outside") -> dict[str, Any]:
    """A peer with a port, or a client; without rules, and without the sockets of this one machine of all hosts."""
    config = session_config(network, NAME, role)
    link = link_of(network)
    config["transport"]["link"]["protocols"] = [link]
    for way in ("listen", "connect"):
        endpoints = config[way].get("endpoints", [])
        config[way]["endpoints"] = [each for each in endpoints if each.startswith(f"{link}/")]
    config["access_control"] = {"enabled": False}
    return config


def as_a_home_has_it() -> dict[str, Any]:
    return bare(NetworkConfig())


def waiting_to_be_called() -> dict[str, Any]:
    """As a home has it, but that it calls nobody. Of two peers the one of the greater id calls, so its own is least."""
    config = as_a_home_has_it() | {"id": "1"}
    config["connect"]["endpoints"] = []
    for way in ("multicast", "gossip"):
        config["scouting"].setdefault(way, {})["autoconnect"] = {"peer": []}
    return config


def with_keys(bundle: Path, role: Role = "outside") -> dict[str, Any]:
    """As the robot's own hosts have it, with rules that hold back nothing of one's own."""
    return bare(
        NetworkConfig(
            mode="secured", connect=(address("robot"),), keys=str(bundle), access=AccessConfig(robot=("robot",))
        ),
        role,
    )


def without_certificate(keys: Path) -> dict[str, Any]:
    config = with_keys(keys / "desk")
    config["listen"]["endpoints"] = []  # Zenoh opens no port for TLS without a certificate
    config["transport"]["link"]["tls"] = {"root_ca_certificate": str(keys / "ca.pem")}
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


def configs(lab: Lab, keys: Path) -> dict[str, dict[str, Any]]:
    """By kind of stranger."""
    return {
        "no-certificate": without_certificate(keys),
        "another-authority": with_keys(anothers(lab)),
        "expired": with_keys(expired(keys)),
        "plain-tcp": bare(NetworkConfig(mode="fixed", connect=(address("robot"),))),
        "multicast": as_a_home_has_it(),
    }


@pytest.mark.usefixtures("up")
def test_an_open_network_is_open(lab: Lab, strangers: dict[str, Machine]) -> None:
    """What the secured one is held against: a stranger hears the robot, and the robot calls it.

    It may drive as an operator does. What it says as guard moves nothing, and keeps nobody from driving.
    """
    armed_and_at_rest(lab)
    began_us = lab.hardware.simulator.now()
    lab.switch.count_calls(lab.machines["robot"], *(f"{NETWORK}.{number}" for number in KINDS.values()))
    # One that calls nobody: else it may be the first to call, and nobody calls twice.
    silent = Attempt(lab, strangers["plain-tcp"], waiting_to_be_called(), "guards")
    with silent, Attempt(lab, strangers["multicast"], as_a_home_has_it(), "guards") as attempt:
        attempt.hears(HEARD)
        silent.hears(HEARD)
        assert silent.told().links
        assert lab.switch.calls() > 0
        assert lab.hardware.last_driven(began_us) is None
        lab.hardware.drive()


@pytest.mark.usefixtures("secured")
def test_driven_with_certificates(lab: Lab) -> None:
    """The emergency stop, released before the network was secured, still is: its volume is one for both Composes."""
    lab.hardware.drive()


@pytest.mark.usefixtures("secured")
def test_strangers_are_nobody(lab: Lab, strangers: dict[str, Machine], keys: Path) -> None:
    """All at once, and for as long as one with a certificate needs on the same hosts to hear a good deal."""
    armed_and_at_rest(lab)
    began_us = lab.hardware.simulator.now()
    lab.switch.count_calls(lab.machines["robot"], *(f"{NETWORK}.{number}" for number in KINDS.values()))
    with ExitStack() as stack:
        attempts: dict[str, Attempt] = {}
        for kind, config in configs(lab, keys).items():
            attempts[kind] = stack.enter_context(Attempt(lab, strangers[kind], config))
        for attempt in attempts.values():
            attempt.told()
        # The certificate is of another address, at which nobody could call them: so they are clients, as commands are.
        known = [
            stack.enter_context(Attempt(lab, machine, with_keys(keys / "desk", "client"), "listens"))
            for machine in strangers.values()
        ]
        for one in known:
            one.hears(HEARD)
        assert {kind: attempt.tells_anew() for kind, attempt in attempts.items()} == dict.fromkeys(KINDS, Told(0, []))
        assert lab.switch.calls() == 0, "the robot has called a stranger"
    assert lab.hardware.last_driven(began_us) is None
    lab.hardware.drive()


@pytest.mark.usefixtures("secured")
def test_who_is_known_does_no_more_than_it_may(lab: Lab, keys: Path) -> None:
    refused = {"desk": "cmd_vel/joystick", "laptop": "cmd_vel/keyboard"}
    armed_and_at_rest(lab)
    began_us = lab.hardware.simulator.now()

    def said() -> bool:
        """Whether a line of the sentry names each of them with each key."""
        lines = lab.compose("robot", "logs", "--no-color", "sentry", program=CURRENT_COMPOSE).splitlines()
        return all(
            any(f"refused {host}" in line and f"put on giraff/{NAME}/{one};" in line for line in lines)
            for host, key in refused.items()
            for one in (key, "cmd_vel")
        )

    with ExitStack() as stack:
        for host in refused:
            attempt = stack.enter_context(Attempt(lab, lab.machines[host], with_keys(keys / host)))
            attempt.hears(HEARD)  # it may read
        wait(said, PATIENCE, what="both hosts in the robot's log", every=1.0)
    assert lab.hardware.last_driven(began_us) is None
    lab.hardware.drive()


def armed_and_at_rest(lab: Lab) -> None:
    lab.hardware.drive()
    lab.hardware.simulator.tilt(0.0, 0.0)
    lab.hardware.run(1.0)
    wait(lambda: not lab.hardware.drives(), PATIENCE, what="wheels at rest")
