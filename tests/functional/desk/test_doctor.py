"""`giraff doctor`: silent beside a healthy robot, and with one thing wrong it names that."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from giraff_cli.keys import make_authority, make_bundle
from giraff_cli.watcher import free_port
from giraff_schemas.topics import alive_key
from giraff_schemas.wire import BoardKind
from giraff_sim.board import ROOT
from tests.functional.desk.sick import (
    Told,
    as_nobody,
    board_of_other_protocol,
    doctor,
    faults,
    half_asleep,
    instead,
    one_fault,
    until,
    with_clock,
    with_other_sources,
)
from tests.support.elsewhere import GIRAFF, clean
from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.sites import Sites

HEALTHY: Told = (0, [])


@pytest.fixture(scope="module")
def started(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("sick"), boards="host") as robot:
        yield robot


@pytest.fixture
def robot(started: ProcessRobot) -> ProcessRobot:
    """A healthy one."""
    return healed(started)


def healed(robot: ProcessRobot) -> ProcessRobot:
    until(robot, lambda: ask(robot), lambda told: told == HEALTHY)
    return robot


def ask(robot: ProcessRobot, *words: str, **elsewhere: tuple[str, ...]) -> Told:
    return doctor(robot.environment, *words, cwd=robot.directory, **elsewhere)


def becomes(robot: ProcessRobot, *words: str) -> str:
    """The one fault that it names, which has all these words."""

    def is_named(told: Told) -> bool:
        return len(faults(told)) == 1 and all(word in faults(told)[0] for word in words)

    return one_fault(until(robot, lambda: ask(robot), is_named))


def names(robot: ProcessRobot, *words: str) -> Told:
    """It names a fault that has all these words, among others that come of it."""

    def is_named(told: Told) -> bool:
        return any(all(word in fault for word in words) for fault in faults(told))

    told = until(robot, lambda: ask(robot), is_named)
    assert told[0] == 1
    return told


def test_a_healthy_robot_is_told_in_one_line(robot: ProcessRobot) -> None:
    done = subprocess.run([GIRAFF, "doctor"], env=robot.environment, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done
    [line] = done.stdout.splitlines()
    assert line.startswith("sim-test: 5 services on 1 host, ")
    assert line.endswith(": no fault found")


def test_a_port_that_is_missing(robot: ProcessRobot) -> None:
    with instead(robot, "ranger", robot.environment | {"GIRAFF_RANGER_PORT": "/dev/giraff-nowhere"}):
        becomes(robot, "ranger on ", "/dev/giraff-nowhere: no such port -> plug the board in")


def test_a_port_that_is_not_permitted(robot: ProcessRobot) -> None:
    with as_nobody(robot, "ranger", "GIRAFF_RANGER_PORT"):
        becomes(robot, "ranger on ", "/dev/pts/", "not permitted", "(dialout)")


def test_a_board_with_another_protocol(robot: ProcessRobot) -> None:
    port = robot.directory / "other-board"
    with board_of_other_protocol(port, BoardKind.RANGER):
        other = robot.environment | {"GIRAFF_RANGER_PORT": str(port)}
        with instead(robot, "ranger", other):
            becomes(robot, "ranger on ", "the board speaks protocol", "reflash it: make -C firmware flash BOARD=ranger")
        robot.kill("ranger")
        told = faults(doctor(other, cwd=robot.directory))
        assert any("ranger's board: " in fault and "reflash it" in fault for fault in told), told
    robot.start("ranger")


def test_a_service_that_does_not_run(robot: ProcessRobot) -> None:
    robot.kill("guard")
    becomes(robot, "guard: giraff_guard is not running, or hangs: nothing moves", "systemctl start giraff-guard")
    robot.start("guard")


def test_a_service_that_hangs(robot: ProcessRobot) -> None:
    robot.signal("ranger", signal.SIGSTOP)
    try:
        becomes(robot, "ranger: giraff_ranger is not running, or hangs: the robot is blind", "start it")
    finally:
        robot.signal("ranger", signal.SIGCONT)


def test_a_rate_that_is_too_low(robot: ProcessRobot) -> None:
    with half_asleep(robot.pid("guard")):
        names(robot, "guard: cmd_vel comes at ", "instead of 50", "overloaded")


def test_two_robots_of_one_name(robot: ProcessRobot) -> None:
    robot.start_second("guard")
    robot.start_second("base", GIRAFF_BASE_PORT=str(robot.directory / "nothing"))
    try:
        names(robot, "robot: two robots are called sim-test: several base, guard", "give one of them another name")
    finally:
        robot.kill("second base")
        robot.kill("second guard")


def test_a_second_guard(robot: ProcessRobot) -> None:
    robot.start_second("guard")
    try:
        names(robot, "guard: 2 giraff_guard run for sim-test", f"pid {robot.pid('second guard')}", "end all but one")
    finally:
        robot.kill("second guard")


def test_a_clock_that_is_wrong(robot: ProcessRobot) -> None:
    with instead(robot, "odometry", with_clock(robot.environment, robot.directory / "clock", 5.0)):
        becomes(robot, "clock: the clock of ", " is 5.0 s ahead of this machine's", "timedatectl set-ntp true")


def test_versions_that_differ(robot: ProcessRobot) -> None:
    with instead(robot, "odometry", with_other_sources(robot.environment, robot.directory / "other")):
        fault = becomes(robot, "version: versions differ: ", "(odometry)", "install the same version on all machines")
        assert fault.count("0.1.0-") == 2


def test_a_disk_that_is_nearly_full(robot: ProcessRobot) -> None:
    state = robot.environment["STATE_DIRECTORY"]
    script = 'mount -t tmpfs -o size=1m tmpfs "$0" && exec "$@"'
    user = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    fault = one_fault(ask(robot, before=("unshare", *user, "--mount", "sh", "-c", script, state)))
    assert fault.startswith(f"disk: {state}: 1 MB of 1 MB are free -> delete old recordings")


def test_an_emergency_stop_is_told_and_is_no_fault(robot: ProcessRobot) -> None:
    assert robot.giraff("estop", "engage", "--reason", "a cat") == 0
    told = until(robot, lambda: ask(robot), lambda told: bool(told[1]))
    assert robot.giraff("estop", "reset") == 0
    assert told[0] == 0
    assert [(each["severity"], each["about"]) for each in told[1]] == [("note", "e-stop")]
    assert told[1][0]["what"].endswith(": a cat")


def test_which_of_two_robots(robot: ProcessRobot) -> None:
    environment = {name: value for name, value in robot.environment.items() if name != "GIRAFF_ROBOT_NAME"}
    environment["GIRAFF_CONFIG"] = str(unnamed(robot.directory))
    with robot.observer.session.liveliness().declare_token(alive_key("sim-other", "base", "1")):
        command = [str(GIRAFF), "doctor"]
        done = subprocess.run(command, env=environment, check=False, capture_output=True, text=True, timeout=30.0)
    assert (done.returncode, done.stdout) == (2, "")
    assert "several robots are on the network; name one: --robot sim-other, --robot sim-test" in done.stderr


def unnamed(folder: Path) -> Path:
    """A robot file that names no robot."""
    path = folder / "unnamed.toml"
    path.write_text("")
    return path


@contextmanager
def service_of(environment: dict[str, str], log: Path, before: tuple[str, ...] = ()) -> Iterator[None]:
    """A process of a robot, somewhere."""
    with log.open("wb") as out:
        command = [*before, sys.executable, "-P", "-m", "giraff_odometry"]
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
    return folder


def secured(keys: Path, rendezvous: str) -> dict[str, str]:
    """A host of a secured network, which is all on this machine."""
    access = keys.parent / "secured.toml"
    access.write_text((ROOT / "deploy" / "robot.toml").read_text() + '\n[network.access]\nrobot = ["pc", "old"]\n')
    given = settings(mode="secured", keys=str(keys), rendezvous=rendezvous)
    return given | {"GIRAFF_CONFIG": str(access)}


def test_a_certificate_that_has_expired(keys: Path, tmp_path: Path) -> None:
    told = doctor(secured(keys / "ours" / "old", f"127.0.0.1:{free_port()}"), cwd=tmp_path)
    (fault,) = [each for each in faults(told) if each.startswith("certificates: ")]
    assert "keys of old: expired" in fault
    assert "giraff keys host old" in fault
    assert told[0] == 1


@pytest.mark.parametrize(
    ("theirs", "ours", "words"),
    [
        ("theirs/pc", "ours/pc", ("not trusted here", "with the same giraff keys folder")),
        ("ours/old", "ours/pc", ("not trusted here: certificate has expired", "giraff keys host NAME --renew")),
    ],
    ids=["wrong CA", "expired over there"],
)
def test_a_certificate_that_is_not_trusted(
    keys: Path, tmp_path: Path, theirs: str, ours: str, words: tuple[str, ...]
) -> None:
    rendezvous = f"127.0.0.1:{free_port()}"
    log = tmp_path / "odometry.log"
    with service_of(secured(keys / theirs, rendezvous), log):
        told: Told = (0, [])
        for _ in range(10):
            told = doctor(secured(keys / ours, rendezvous), cwd=tmp_path)
            if any("certificates: " in each for each in faults(told)):
                break
    (fault,) = [each for each in faults(told) if each.startswith("certificates: ")]
    assert all(word in fault for word in (rendezvous, *words)), fault


HOME, AWAY = "home", "away"


def test_networks_that_do_not_let_through(tmp_path: Path) -> None:
    log = tmp_path / "odometry.log"
    with Sites(HOME, AWAY, routed=True) as sites, service_of(settings(), log, tuple(sites.command(HOME))):
        away = tuple(sites.command(AWAY))
        home = sites.address(HOME)

        def ask_away(*words: str, **network: str) -> list[str]:
            return faults(doctor(settings(**network), "--for", "1", *words, before=away, cwd=tmp_path))

        assert any("network: no robot called sim-far is heard: nobody answers" in each for each in ask_away())
        reached = ask_away("--connect", home)
        assert any("network: multicast does not get through" in each for each in reached), reached
        assert any("giraff_base is not running" in each for each in reached)

        wrong = ask_away("--connect", "192.168.99.9")
        where = f"is in none of this machine's networks (uplink {sites.address(AWAY)}/24)"
        assert any("192.168.99.9:7447 does not answer" in each and where in each for each in wrong), wrong
        nobody = ask_away("--connect", sites.router(AWAY))
        assert any("is there, but nothing of a robot listens" in each for each in nobody), nobody
        secure = ask_away("--connect", home, mode="fixed")
        assert not any("multicast" in each for each in secure), secure

        sites.pull(AWAY)
        sites.await_link(AWAY, "DOWN")
        pulled = ask_away("--connect", home)
        assert any("this machine has no network: no interface is up" in each for each in pulled), pulled
