"""`giraff run` as a process, for a robot that nobody else is called like, and all of its processes."""

import contextlib
import os
import secrets
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import msgspec

from giraff_schemas.services import SIMULATED
from giraff_sim.board import ROOT
from tests.support.process_robot import PATIENCE

GIRAFF = Path(sys.executable).with_name("giraff")
PROCESSES = len(SIMULATED) + 2  # with the simulator, and the one that started all
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
        self.left = Path(mkdtemp(prefix="run-"))  # short: a socket's path is at most 107 bytes long
        self.robot = f"sim-{secrets.token_hex(4)}"
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            "GIRAFF_ROBOT_NAME": self.robot,
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "TMPDIR": str(self.left),
            "XDG_STATE_HOME": str(directory / "state"),
        }

    def start(self, *options: str, local: bool = True, **popen: Any) -> subprocess.Popen[str]:
        streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        command = [str(GIRAFF), "run", *(["--local"] if local else []), *options]
        return subprocess.Popen(command, env=self.environment, cwd=self.directory, **streams | popen)

    def run(self, *options: str, local: bool = True, patience: float = PATIENCE) -> tuple[int, str, str]:
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

    def wait_until_it_drives(self, process: subprocess.Popen[str], more: int = 0) -> None:
        """Read its lines up to one that says so. `more`: processes beside those of every run."""
        line_of(process, "base driving")
        assert len(self.pids()) == PROCESSES + more

    def summary(self) -> dict[str, Any]:
        """Of a run that was started with `--summary summary.json`."""
        told: dict[str, Any] = msgspec.json.decode((self.directory / "summary.json").read_bytes())
        return told

    def leaves_nothing(self) -> bool:
        return not self.pids() and not list(self.left.iterdir())


@contextmanager
def command_in(directory: Path) -> Iterator[Command]:
    """Whatever it has started is gone with the block."""
    made = Command(directory)
    try:
        yield made
    finally:
        for pid in made.pids():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        shutil.rmtree(made.left)


def line_of(process: subprocess.Popen[str], words: str) -> str:
    """The next line of standard output that says so."""
    assert process.stdout is not None
    for line in process.stdout:
        print(line, end="")  # of one that fails: what it says instead
        if words in line:
            return line
    assert process.stderr is not None
    raise AssertionError(f"it ended without {words!r}: {process.stderr.read()}")
