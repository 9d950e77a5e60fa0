"""deploy/systemd, judged by systemd's own tools: needs what Debian's package systemd brings, not a running systemd."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_core.network import NetworkConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import load
from giraff_schemas.boards import ALL_BOARDS
from giraff_schemas.services import KEYBOARD, SERVICES
from giraff_sim.board import ROOT

UNITS = ROOT / "deploy" / "systemd"
DROP_INS = [path.name for path in UNITS.glob("*.service.d")]
FIREWALL = "giraff-firewall.service"
PROCESSES = [board.name for board in ALL_BOARDS if board.is_process]
MOST_EXPOSED = 20  # tenths of systemd's own scale, which ends at 100; 17 when this was written


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with systemd's own units and the programs that ours start."""
    directory = tmp_path_factory.mktemp("machine")
    own = Path("/usr/lib/systemd/system")
    assert own.is_dir(), "systemd's own units are not here: apt-get install systemd"
    shutil.copytree(own, directory / "usr/lib/systemd/system", symlinks=True)
    (directory / "lib").symlink_to("usr/lib")
    for name in (
        "opt/giraff/bin/python",
        *(f"opt/giraff/boards/{board}" for board in PROCESSES),
        "usr/sbin/nft",
        "bin/sh",
    ):
        program = directory / name
        program.parent.mkdir(parents=True, exist_ok=True)
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)
    return directory


@pytest.fixture
def machine(bare: Path) -> Iterator[Path]:
    """With our units, which a test may change."""
    ours = bare / "etc/systemd/system"
    ours.mkdir(parents=True)
    for name in ("giraff@.service", "giraff-board@.service", "giraff.target"):
        shutil.copy(UNITS / name, ours)
    shutil.copy(ROOT / "deploy" / "firewall" / FIREWALL, ours)
    for drop_in in DROP_INS:
        shutil.copytree(UNITS / drop_in, ours / drop_in)
    yield bare
    shutil.rmtree(bare / "etc")


def analyze(machine: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    assert shutil.which("systemd-analyze"), "systemd-analyze is not here: apt-get install systemd"
    command = ["systemd-analyze", f"--root={machine}", *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def edit(machine: Path, old: str, new: str) -> None:
    unit = machine / "etc/systemd/system/giraff@.service"
    text = unit.read_text()
    assert old in text
    unit.write_text(text.replace(old, new))


def test_systemd_finds_nothing_wrong(machine: Path) -> None:
    units = [f"giraff@{service.name}.service" for service in SERVICES if service.entry and service != KEYBOARD]
    units += [f"giraff-board@{board}.service" for board in PROCESSES]
    run = analyze(machine, "verify", *units, "giraff.target", FIREWALL)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("WatchdogSec=3", "WatchdogSecs=3"),
        ("DeviceAllow=char-188 rw", "DeviceAllow=ttyUSB rw"),
        ("/bin/python", "/bin/no"),
    ],
)
def test_a_mistake_shows(machine: Path, old: str, new: str) -> None:
    edit(machine, old, new)
    assert analyze(machine, "verify", "giraff@base.service").stderr


@pytest.mark.parametrize("service", ["recorder", "localization", "places", "camera", "vision"])
def test_what_is_a_services_own_is_read_for_it_alone(service: str, machine: Path) -> None:
    own = machine / "etc/systemd/system" / f"giraff@{service}.service.d" / "behind.conf"
    own.write_text(own.read_text().replace("CPUWeight=20", "CPUWeight=twenty"))
    assert "Invalid CPU weight" in analyze(machine, "verify", f"giraff@{service}.service").stderr
    assert not analyze(machine, "verify", "giraff@base.service").stderr


def test_systemd_calls_it_little_exposed(machine: Path) -> None:
    judge = ("security", "--offline=true", f"--threshold={MOST_EXPOSED}", "giraff@base.service")
    board = analyze(machine, *judge[:-1], f"giraff-board@{PROCESSES[0]}.service")
    assert board.returncode == 0, board.stdout
    run = analyze(machine, *judge)
    assert run.returncode == 0, run.stdout
    edit(machine, "DynamicUser=yes", "DynamicUser=no")
    edit(machine, "User=giraff-%i", "User=root")
    assert analyze(machine, *judge).returncode != 0


def test_the_examples_of_the_environment_file_are_settings() -> None:
    lines = (UNITS / "giraff.env").read_text().splitlines()
    given = dict(line.removeprefix("#").split("=", 1) for line in lines if line.startswith("#GIRAFF"))
    assert len(given) >= 2
    environment = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")} | given
    assert load("robot", RobotConfig, environment).name == given["GIRAFF_ROBOT_NAME"]
    assert load("network", NetworkConfig, environment).connect == ("192.168.1.20:7447",)
