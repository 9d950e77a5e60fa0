"""`giraff doctor` on machines of a network that does not let through, or does not trust."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from giraff_setup.keys.manage import make_authority, make_bundle
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.functional.desk.sick import (
    doctor,
    faults,
)
from tests.support.desk import run_beside
from tests.support.elsewhere import clean
from tests.support.sites import Sites
from tests.support.waiting import wait


@contextmanager
def running(service: str, environment: dict[str, str], log: Path, before: tuple[str, ...] = ()) -> Iterator[None]:
    """A process of a robot, somewhere."""
    with log.open("wb") as out:
        command = [*before, sys.executable, "-P", "-m", "giraff_node", service]
        process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out)
    try:
        yield
    finally:
        process.kill()
        process.wait()


def settings(**network: str) -> dict[str, str]:
    given = {f"GIRAFF_NETWORK_{name.upper()}": value for name, value in network.items()}
    plain = clean(dict(os.environ)) | {"GIRAFF_ROBOT_NAME": "sim-far", "XDG_STATE_HOME": "/tmp"}  # noqa: S108
    return plain | {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")} | given


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two authorities, each with bundles: of a host, and of one whose time is over."""
    folder = tmp_path_factory.mktemp("keys")
    now = datetime.now(UTC)
    for authority in ("ours", "theirs"):
        make_authority(folder / authority, now - timedelta(days=100))
        make_bundle(folder / authority, "pc", ("192.0.2.1",), days=30, renew=False, moment=now)
        make_bundle(folder / authority, "old", ("192.0.2.1",), days=30, renew=False, moment=now - timedelta(days=60))
    # Written once: a process that starts while it is written anew would read half of it.
    robot = (ROOT / "deploy" / "robot.toml").read_text()
    (folder / "secured.toml").write_text(f'{robot}\n[network.access]\nrobot = ["pc", "old"]\n')
    return folder


def secured(keys: Path, rendezvous: str) -> dict[str, str]:
    """A host of a secured network, which is all on this machine: with sockets of its own, which need no certificate."""
    given = settings(mode="secured", keys=str(keys), rendezvous=rendezvous, sockets=f"{keys}-sockets")
    return given | {"GIRAFF_CONFIG": str(keys.parent.parent / "secured.toml")}


def test_certificates_that_are_not_trusted(keys: Path, tmp_path: Path) -> None:
    """Of another authority, and one that has expired over there."""

    def told(row: tuple[str, str]) -> str:
        theirs, ours = row
        rendezvous = f"127.0.0.1:{free_port()}"
        found: list[str] = []

        def is_told() -> bool:
            every = faults(doctor(secured(keys / ours, rendezvous), cwd=tmp_path))
            found[:] = [each for each in every if each.startswith("certificates: ")]
            return bool(found)

        with running("door", secured(keys / theirs, rendezvous), tmp_path / f"{theirs.replace('/', '-')}.log"):
            wait(is_told, 180.0, what=f"{theirs} is not told")
        [fault] = found
        assert rendezvous in fault
        return fault

    said = run_beside(told, [("theirs/pc", "ours/pc"), ("ours/old", "ours/pc")])
    stranger, expired = said.values()
    assert "not trusted here" in stranger
    assert "with the same giraff keys folder" in stranger
    assert "not trusted here: certificate has expired" in expired
    assert "giraff keys host NAME --renew" in expired


HOME, AWAY = "home", "away"


def test_networks_that_do_not_let_through(tmp_path: Path) -> None:
    at = {site: settings(sockets=str(tmp_path / site)) for site in (HOME, AWAY)}  # they share the file system
    with Sites(HOME, AWAY, routed=True) as sites, ExitStack() as robot:
        for service in ("door", "odometry"):
            robot.enter_context(running(service, at[HOME], tmp_path / f"{service}.log", tuple(sites.command(HOME))))
        away = tuple(sites.command(AWAY))
        home = ("--connect", sites.address(HOME))

        def ask_away(*words: str, **network: str) -> list[str]:
            given = at[AWAY] | settings(**network)
            return faults(doctor(given, "--for", "1", *words, before=away, cwd=tmp_path))

        reached: list[list[str]] = []

        def is_reached() -> bool:
            reached.append(ask_away(*home))
            return any("giraff_base is not running" in each for each in reached[-1])

        wait(is_reached, 60.0, what="the robot at home")
        assert any("network: multicast does not get through" in each for each in reached[-1]), reached[-1]
        alone = ask_away()
        assert any(
            "network: no robot called sim-far is heard: nobody answers by multicast" in each for each in alone
        ), alone
        wrong = ask_away("--connect", "192.168.99.9")
        where = f"is in none of this machine's networks (uplink {sites.address(AWAY)}/24)"
        assert any("192.168.99.9:7447 does not answer" in each and where in each for each in wrong), wrong
        nobody = ask_away("--connect", sites.router(AWAY))
        assert any("refuses: no door listens" in each for each in nobody), nobody
        secure = ask_away(*home, mode="fixed")
        assert not any("multicast" in each for each in secure), secure

        sites.pull(AWAY)
        sites.await_link(AWAY, "DOWN")
        pulled = ask_away(*home)
        assert any("this machine has no network: no interface is up" in each for each in pulled), pulled
