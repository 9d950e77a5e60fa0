"""`giraff doctor`: silent beside a healthy robot, and with one thing wrong it names that."""

import os
import signal
import subprocess
from collections.abc import Iterator

import pytest

from giraff_schemas.wire import BoardKind
from tests.functional.desk.sick import (
    Told,
    as_nobody,
    board_of_other_protocol,
    doctor,
    faults,
    instead,
    until,
    with_clock,
    with_other_sources,
)
from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import ProcessRobot, process_robot


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    """A healthy one, as soon as what was done to it is over. Another user, and who hangs, are met at its door."""
    with process_robot(tmp_path_factory.mktemp("sick"), boards="host") as started:
        started.start("door")
        yield started


def ask(robot: ProcessRobot, *words: str, **elsewhere: tuple[str, ...]) -> Told:
    return doctor(robot.environment, *words, cwd=robot.directory, **elsewhere)


def becomes(robot: ProcessRobot, *words: str, **elsewhere: tuple[str, ...]) -> Told:
    """It names one fault, which has all these words."""

    def is_named(told: Told) -> bool:
        return len(faults(told)) == 1 and all(word in faults(told)[0] for word in words)

    told = until(robot, lambda: ask(robot, **elsewhere), is_named)
    assert told[0] == 1
    return told


def names(robot: ProcessRobot, *all_words: tuple[str, ...]) -> list[str]:
    """It names faults each of which has all these words, among others that come of them."""

    def are_named(told: Told) -> bool:
        return all(any(all(word in fault for word in words) for fault in faults(told)) for words in all_words)

    told = until(robot, lambda: ask(robot), are_named)
    assert told[0] == 1
    return faults(told)


def test_a_healthy_robot_is_told_in_one_line_after_a_name_that_is_none(robot: ProcessRobot) -> None:
    said: list[str] = []

    def is_healthy() -> bool:
        done = subprocess.run([GIRAFF, "doctor"], env=robot.environment, check=False, capture_output=True, text=True)
        said.append(done.stderr + done.stdout)
        return (
            done.returncode == 0 and "sim-test: 6 services" in done.stdout
        )  # on its loopback it is well without a door

    with robot.observer.session.liveliness().declare_token("giraff/a b/alive/base/\x1b[2J"):
        robot.wait("health", is_healthy, 60.0)
    odd, line = said[-1].splitlines()
    assert odd.endswith(r"no service can have, left out: 'giraff/a b/alive/base/\x1b[2J'")
    assert line.startswith("sim-test: 6 services on 1 host, ")
    assert line.endswith(": no fault found")


def test_ports_that_are_missing_not_permitted_or_another_board_s(robot: ProcessRobot) -> None:
    port = robot.directory / "other-board"
    nowhere = robot.environment | {"GIRAFF_BASE_PORT": "/dev/giraff-nowhere"}
    other = robot.environment | {"GIRAFF_RANGER_PORT": str(port)}
    with (
        board_of_other_protocol(port, BoardKind.RANGER),
        instead(robot, "base", nowhere),
        as_nobody(robot, "joystick", "GIRAFF_JOYSTICK_PORT"),
    ):
        with instead(robot, "ranger", other):
            names(
                robot,
                ("base on ", "/dev/giraff-nowhere: no such port -> plug the board in"),
                ("joystick on ", "/dev/pts/", "not permitted", "(dialout)"),
                ("ranger on ", "the board speaks protocol", "reflash it: make -C firmware flash BOARD=ranger"),
            )
        robot.kill("ranger")
        told = faults(doctor(other, cwd=robot.directory))
        assert any("ranger's board: " in fault and "reflash it" in fault for fault in told), told
    robot.start("ranger")


def test_a_service_that_does_not_run(robot: ProcessRobot) -> None:
    robot.kill("guard")
    becomes(robot, "guard: giraff_guard is not running, or hangs: nothing moves", "systemctl enable --now giraff@guard")
    robot.start("guard")


def test_a_service_that_hangs_and_one_that_runs_twice(robot: ProcessRobot) -> None:
    robot.start_second("guard")
    robot.signal("ranger", signal.SIGSTOP)
    try:
        names(
            robot,
            ("guard: 2 giraff_guard run for sim-test", f"pid {robot.pid('second guard')}", "end all but one"),
            ("ranger: giraff_ranger is not running, or hangs: the robot is blind", "start it"),
        )
    finally:
        robot.signal("ranger", signal.SIGCONT)
        robot.kill("second guard")


def of_geometry(told: Told) -> list[str]:
    return [f"{each['what']} -> {each['fix']}" for each in told[1] if each["about"] == "geometry"]


def test_a_clock_that_is_wrong_versions_that_differ_and_a_geometry_of_before(robot: ProcessRobot) -> None:
    ahead = with_clock(robot.environment, robot.directory / "clock", 5.0)
    other = with_other_sources(robot.environment, robot.directory / "other")
    # As one that was not restarted since the robot file was changed.
    changed = {"PYTHONPATH": f"{ahead['PYTHONPATH']}:{other['PYTHONPATH']}", "GIRAFF_ROBOT_TRACK_WIDTH": "0.48"}
    with instead(robot, "odometry", robot.environment | changed):
        told = names(
            robot,
            ("clock: the clock of ", " s ahead of this machine's", "timedatectl set-ntp true"),
            ("version: versions differ: ", "(odometry)", "install the same version on all machines"),
        )
        [line] = of_geometry(until(robot, lambda: ask(robot), lambda told: bool(of_geometry(told))))
    [version] = [fault for fault in told if fault.startswith("version: ")]
    assert version.count("0.1.0-") == 2
    assert line.startswith(
        "odometry goes by the geometry from before: track_width 0.48, now 0.47 -> restart it at rest"
    )


def test_a_disk_that_is_nearly_full_and_an_emergency_stop_which_is_no_fault(robot: ProcessRobot) -> None:
    assert robot.giraff("estop", "engage", "--reason", "a cat") == 0
    state = robot.environment["STATE_DIRECTORY"]
    script = 'mount -t tmpfs -o size=1m tmpfs "$0" && exec "$@"'
    user = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    elsewhere = ("unshare", *user, "--mount", "sh", "-c", script, state)
    told = becomes(robot, f"disk: {state}: 1 MB of 1 MB are free -> delete old recordings", before=elsewhere)
    [note] = [each for each in told[1] if each["severity"] == "note"]
    assert note["about"] == "e-stop"
    assert note["what"].endswith(": a cat")
