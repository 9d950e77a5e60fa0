"""`giraff run` as people and scripts use it: as a process, from its first word to its last child."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import re
import secrets
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_cli.simulated import SERVICES
from giraff_cli.watcher import Watcher, free_port
from giraff_node.session import NetworkConfig, open_session
from giraff_schemas import topics
from giraff_schemas.topics import alive_key
from giraff_sim.board import ROOT
from giraff_sim.truth import Truth, TruthRanges, draw_truth
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall

GIRAFF = Path(sys.executable).with_name("giraff")
PROCESSES = len(SERVICES) + 2  # with the simulator, and the one that started all
ROWS, COLUMNS = 24, 80


SMALL_ROOM = """
name = "small"
start = { x = 0.0, y = 0.0, yaw_deg = 0.0 }

[[walls]]
name = "all around, near enough to be heard"
closed = true
points = [[-1.0, -1.5], [3.0, -1.5], [3.0, 1.5], [-1.0, 1.5]]
"""


class Command:
    """`giraff run` for a robot that nobody else is called like, with a directory for what it leaves behind."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.left = directory / "tmp"
        self.left.mkdir()
        self.robot = f"sim-{secrets.token_hex(4)}"
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            "GIRAFF_ROBOT_NAME": self.robot,
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "TMPDIR": str(self.left),
        }

    def start(self, *options: str, local: bool = True, **popen: Any) -> subprocess.Popen[str]:
        streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        command = [str(GIRAFF), "run", *(["--local"] if local else []), *options]
        return subprocess.Popen(command, env=self.environment, cwd=self.directory, **streams | popen)

    def run(self, *options: str, local: bool = True, patience: float = 60.0) -> tuple[int, str, str]:
        """Exit code, standard output and standard error of a run that ends by itself."""
        with self.start(*options, local=local) as process:
            try:
                out, err = process.communicate(timeout=patience)
            finally:
                process.kill()
        return process.returncode, out, err

    def pids(self) -> dict[int, str]:
        """Every process of this robot, with its command line: they all have the robot's name in their environment."""
        found = {}
        for entry in Path("/proc").iterdir():
            with contextlib.suppress(OSError):
                if (
                    entry.name.isdigit()
                    and f"GIRAFF_ROBOT_NAME={self.robot}\0".encode() in (entry / "environ").read_bytes()
                ):
                    found[int(entry.name)] = (entry / "cmdline").read_bytes().decode().replace("\0", " ")
        return found

    def pid(self, module: str) -> int:
        [pid] = [pid for pid, line in self.pids().items() if f"-m {module} " in line]
        return pid

    def wait_until_it_drives(self, process: subprocess.Popen[str]) -> None:
        """Read its lines up to one that says so."""
        assert process.stdout is not None
        for line in process.stdout:
            print(line, end="")  # of one that fails: why it does not
            if "base driving" in line:
                assert len(self.pids()) == PROCESSES
                return
        assert process.stderr is not None
        raise AssertionError(f"it ended without driving: {process.stderr.read()}")

    def leaves_nothing(self) -> bool:
        return not self.pids() and not list(self.left.iterdir())


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    made = Command(tmp_path)
    yield made
    for pid in made.pids():
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def read_summary(path: Path) -> dict[str, Any]:
    told: dict[str, Any] = msgspec.json.decode(path.read_bytes())
    return told


def test_it_drives_around_the_room_and_sums_up(command: Command) -> None:
    path = command.directory / "summary.json"
    begin_ns = time.monotonic_ns()
    code, out, err = command.run("--for", "20", "--truth", "exact", "--summary", str(path))
    assert (code, err) == (0, "")
    assert command.leaves_nothing()
    told = read_summary(path)
    assert told["odom_error_m"] < 0.01 * told["distance_m"]
    assert told["odom_error_deg"] < 1.0
    assert 0.0 < told["odom_sigma_m"] < 0.04 * told["distance_m"]
    assert told["truth"] == "exact"
    assert (told["contacts"], told["line_errors"]) == (0, 0)
    assert told["closest_m"] > 0.1
    assert (told["seed"], told["failures"]) == (1, [])
    assert f"distance  {told['distance_m']:.2f} m" in out
    with by_the_wall(begin_ns):
        require_its_pace(told)
        assert 20 <= sum(" | " in line for line in out.splitlines()) <= 27


def require_its_pace(told: dict[str, Any]) -> None:
    """Of 20 s in which nothing held it up."""
    assert told["distance_m"] > 4.0
    assert told["frames_lost"] == 0
    assert 20.0 <= told["duration_s"] < 25.0
    assert abs(told["skew_percent"]) < 2.0
    assert 0.0 < told["age_ms"]["p50"] <= told["age_ms"]["p99"] < 200.0
    for topic in (topics.TICK, topics.TILT, topics.CMD_VEL, topics.WHEELS, topics.ODOM):
        assert told["rates_hz"][topic.key] == pytest.approx(topic.rate_hz, rel=0.02)
    for sensor in ("front_left", "front_right", "rear"):
        assert told["rates_hz"][topics.RANGE.at(sensor).key] == pytest.approx(topics.RANGE.rate_hz, rel=0.05)


def test_a_script_drives_the_boards_that_were_compiled_for_this_machine(command: Command) -> None:
    script, path = command.directory / "script.csv", command.directory / "summary.json"
    script.write_text("t,x,y,z\n0,0,0,9.81\n6,5,0,8.4\n8,0,0,9.81\n")
    world = command.directory / "world.toml"
    world.write_text(SMALL_ROOM)
    options = ["--boards", "host", "--seed", "7", "--tilt-script", str(script), "--summary", str(path)]
    options += ["--world", str(world)]
    code, out, err = command.run("--for", "9", *options)
    assert (code, err) == (0, "")
    told = read_summary(path)
    assert (told["boards"], told["seed"]) == ("host", 7)
    assert told["truth"] == "calibrated"
    drawn = msgspec.convert(told["drawn"], Truth)
    assert drawn == draw_truth("calibrated", TruthRanges(), 7)
    assert "true robot  calibrated: wheels" in out
    assert 0.5 < told["distance_m"] < 1.3  # two seconds at no more than 0.6 m/s
    assert command.leaves_nothing()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_it_well(command: Command, number: signal.Signals) -> None:
    path = command.directory / "summary.json"
    with command.start("--summary", str(path)) as process:
        command.wait_until_it_drives(process)
        process.send_signal(number)
        out, err = process.communicate(timeout=15.0)
    assert (process.returncode, err) == (0, "")
    assert "odometry off by" in out
    assert read_summary(path)["odom_error_m"] < 0.02
    assert command.leaves_nothing()


def test_being_killed_it_takes_everything_along(command: Command) -> None:
    with command.start() as process:
        command.wait_until_it_drives(process)
        process.kill()
    wait(lambda: not command.pids(), 3.0, what="the end of all children")
    assert list(command.left.iterdir()), "nobody could remove it"
    code, _, err = command.run("--for", "0.5")
    assert (code, err) == (0, "")
    assert command.leaves_nothing(), "not even what the killed one left"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("later", [0.0, 0.03, 0.1, 0.3])
def test_a_signal_at_its_very_start_ends_it_without_a_traceback(
    command: Command, number: signal.Signals, later: float
) -> None:
    """What the interpreter itself says before it has come to our first line is not ours to change."""
    with command.start() as process:
        maps = Path(f"/proc/{process.pid}/maps")
        wait(lambda: re.search("lib-dynload|site-packages", maps.read_text()) is not None, what="its first import")
        time.sleep(later)
        process.send_signal(number)
        _, err = process.communicate(timeout=30.0)
    assert err == ""
    assert process.returncode in (0, -number)
    assert not command.pids()


def test_when_its_reader_goes_it_ends(command: Command) -> None:
    with command.start() as process:
        command.wait_until_it_drives(process)
        assert process.stdout is not None
        process.stdout.close()
        assert process.wait(20.0) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""
    assert command.leaves_nothing()


def test_a_service_that_dies_is_named_and_the_others_go_on(command: Command) -> None:
    path = command.directory / "summary.json"
    with command.start("--for", "8", "--summary", str(path)) as process:
        command.wait_until_it_drives(process)
        os.kill(command.pid("giraff_odometry"), signal.SIGKILL)
        out, err = process.communicate(timeout=30.0)
    assert process.returncode == 1
    assert "odometry ended by itself (SIGKILL), its log ends:\n    {" in err
    assert "base driving" in out, "losing odometry changes no motion"
    told = read_summary(path)
    assert told["odom_error_m"] is None
    assert len(told["failures"]) == 1
    [kept] = command.left.iterdir()
    assert f"the logs are in {kept}" in err
    assert {f"{name}.log" for name in ("simulator", *SERVICES)} <= {file.name for file in kept.iterdir()}
    assert not command.pids()


def test_without_its_world_it_ends(command: Command) -> None:
    with command.start() as process:
        command.wait_until_it_drives(process)
        os.kill(command.pid("giraff_sim"), signal.SIGKILL)
        _, err = process.communicate(timeout=15.0)
    assert process.returncode == 1
    assert "simulator ended by itself (SIGKILL)" in err
    assert not command.pids()


def test_a_run_of_the_same_name_on_this_host_is_refused(command: Command) -> None:
    with command.start(local=False) as process:
        command.wait_until_it_drives(process)
        code, out, err = command.run(local=False)
        assert (code, out) == (2, "")
        assert f"a run of {command.robot} is going on on this host; end it, or give this one another name" in err
        assert len(command.pids()) == PROCESSES
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=15.0)
    assert process.returncode == 0
    assert command.leaves_nothing()


def test_a_robot_of_the_same_name_on_the_network_is_refused(command: Command) -> None:
    elsewhere = f"127.0.0.1:{free_port()}"
    robot_file = command.directory / "robot.toml"
    settings = (ROOT / "deploy" / "robot.toml").read_text()
    robot_file.write_text(settings.replace("[network]", f'[network]\nconnect = ["{elsewhere}"]'))
    command.environment["GIRAFF_CONFIG"] = str(robot_file)
    other = Watcher(command.robot, open_session(NetworkConfig(rendezvous=elsewhere, local=True), command.robot))
    with other.session.liveliness().declare_token(alive_key(command.robot, "base", "there")):
        code, out, err = command.run("--for", "5", local=False)
    assert other.close()
    assert (code, out) == (2, "")
    assert f"a robot called {command.robot} is on the network already" in err
    assert "another name with GIRAFF_ROBOT_NAME" in err
    assert command.leaves_nothing()


BAD_SCRIPT = "bad.csv"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--for", "-3"], "--for -3: give a positive number of seconds"),
        (["--for", "nan"], "--for nan"),
        (["--for", "soon"], "giraff run: invalid value for '--for'"),
        (["--world", "nowhere.toml"], "nowhere.toml: cannot be read"),
        (["--tilt-script", BAD_SCRIPT], f"{BAD_SCRIPT}:2: x is 'up', not a number"),
        (["--summary", "missing/summary.json"], "cannot be written"),
        (["--boards", "wooden"], "'wooden'"),
        (["--fast"], "giraff run: no such option: --fast"),
    ],
)
def test_bad_input_is_refused_before_anything_is_started(command: Command, options: list[str], told: str) -> None:
    (command.directory / BAD_SCRIPT).write_text("0,0,0,9.81\n1,up,0,9.81\n")
    code, out, err = command.run(*options)
    assert (code, out) == (2, "")
    [line] = err.splitlines()
    assert told in line
    assert command.leaves_nothing()


class Window:
    """A terminal of 80 by 24 with the command in it."""

    def __init__(self, command: Command, *options: str) -> None:
        self.ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        self.before = termios.tcgetattr(theirs)
        command.environment["TERM"] = "xterm-256color"
        self.process = command.start(
            *options, stdin=theirs, stdout=theirs, stderr=theirs, preexec_fn=self._control, start_new_session=True
        )
        self._theirs = theirs
        os.set_blocking(self.ours, False)
        self.text = ""

    @staticmethod
    def _control() -> None:
        """Make it the terminal that Ctrl-C is typed into."""
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    def shows(self, pattern: str) -> bool:
        with contextlib.suppress(BlockingIOError):
            while data := os.read(self.ours, 65536):
                self.text += data.decode(errors="replace")
        return re.search(pattern, self.text) is not None

    def settings(self) -> list[Any]:
        return termios.tcgetattr(self._theirs)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self.ours)
        os.close(self._theirs)


def test_in_a_terminal_there_is_a_live_view_and_ctrl_c_gives_the_terminal_back(command: Command) -> None:
    picture = command.directory / "picture.svg"
    window = Window(command, "--picture", str(picture))
    try:
        wait(lambda: window.shows("driving"), 30.0, what="driving")
        wait(lambda: window.shows(r"odom +(100|99|101)\.\d"), 30.0, what="the rate of odom")
        os.write(window.ours, b"\x03")
        wait(lambda: window.shows("rates in Hz") and window.process.poll() is not None, 15.0, what="the end")
        assert window.process.returncode == 0
        on, off = window.text.index("\x1b[?1049h"), window.text.rindex("\x1b[?1049l")
        assert on < window.text.index("GUARD") < off < window.text.index("distance")
        assert window.text.rindex("\x1b[?25h") > window.text.rindex("\x1b[?25l")
        assert window.settings() == window.before
    finally:
        window.close()
    assert "SERVICES" in picture.read_text()
    assert command.leaves_nothing()
