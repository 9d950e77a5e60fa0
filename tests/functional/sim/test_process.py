"""python -m giraff_sim as others start it."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import BoardKind, HelloFrame, HelloRequestFrame, WheelsFrame
from giraff_sim.board import Implementation
from giraff_sim.control.client import SimulatorClient, SimulatorError
from giraff_sim.truth import Level, TruthRanges, draw_truth
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.sonar import SonarFault
from tests.support.waiting import wait

ROOT = Path(__file__).parents[3]
LIVING_ROOM = ROOT / "deploy" / "worlds" / "living_room.toml"


def command(directory: Path, *more: str) -> list[str]:
    places = ["--ports", str(directory / "ports"), "--control", str(directory / "control")]
    return [sys.executable, "-m", "giraff_sim", *places, "--world", str(LIVING_ROOM), *more]


def environment() -> dict[str, str]:
    return os.environ | {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")}


@contextmanager
def simulator(directory: Path, *more: str) -> Iterator[subprocess.Popen[str]]:
    """A simulator that has said it is ready."""
    process = subprocess.Popen(command(directory, *more), stdout=subprocess.PIPE, text=True, env=environment())
    try:
        assert process.stdout is not None
        ready = json.loads(process.stdout.readline())
        assert ready["ready"] is True
        yield process
    finally:
        process.kill()
        process.communicate()


def hello_of(path: Path, wheels: int = 0) -> HelloFrame:
    """The answer of a base board that is asked for its hello, once at least so many frames of its wheels came, too."""
    descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    decoder = Decoder()
    hellos: list[HelloFrame] = []
    counted = 0

    def complete() -> bool:
        nonlocal counted
        with suppress(BlockingIOError):
            frames = decoder.feed(os.read(descriptor, 65536))
            hellos.extend(frame for frame in frames if isinstance(frame, HelloFrame))
            counted += sum(isinstance(frame, WheelsFrame) for frame in frames)
        return bool(hellos) and counted >= wheels

    try:
        os.write(descriptor, encode(HelloRequestFrame(seq=1).pack()))
        wait(complete, 60.0, what="its hello, and reports of its wheels", every=0.005)
    finally:
        os.close(descriptor)
    return hellos[0]


@pytest.mark.parametrize("level", [None, "exact", "uncalibrated"])
def test_a_seed_is_a_calibrated_robot_unless_another_is_asked_for(tmp_path: Path, level: Level | None) -> None:
    more = () if level is None else ("--truth", level)
    with (
        simulator(tmp_path, "--boards", "host", "--hand", "still", "--seed", "4", *more),
        SimulatorClient(tmp_path / "control") as client,
    ):
        assert client.truth() == draw_truth(level or "calibrated", TruthRanges(), 4)


def test_it_offers_ports_and_control_and_ends_cleanly(tmp_path: Path, implementation: Implementation) -> None:
    with simulator(tmp_path, "--boards", implementation, "--hand", "still") as process:
        assert hello_of(tmp_path / "ports" / "base", wheels=11).board == BoardKind.BASE
        with SimulatorClient(tmp_path / "control") as client:
            first = client.now()
            wait(lambda: client.now() > first + 100_000, 60.0, what="its time going on")
            state = client.state()
            assert set(state.boards) == {"base", "joystick", "ranger"}
            assert all(board.state == "running" and board.plugged for board in state.boards.values())
            assert all(board.complaints == 0 for board in state.boards.values())
            assert state.base is not None
            assert state.base.drive_state == "not_configured"
            assert client.record().driven_ms == 0
            client.fail_bno055(Bno055Fault.FROZEN)
            client.fail_sonar(0, SonarFault.DEAD)
            client.cut_encoder("left", cut=True)
            client.hand("demo")
            client.unplug("base")
            assert not (tmp_path / "ports" / "base").exists()
            assert not client.state().boards["base"].plugged
            client.plug("base")
            assert (tmp_path / "ports" / "base").exists()
            before = client.state().boards["ranger"].resets
            client.reset("ranger", "watchdog")
            assert client.state().boards["ranger"].resets == before + 1
            with pytest.raises(SimulatorError, match="cannot be read"):
                client.hand("/nowhere.csv")
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 0
    assert [path.name for path in (tmp_path / "ports").iterdir() if not path.name.endswith(".eeprom")] == []
    assert not (tmp_path / "control").exists()


def boot_id_of(directory: Path) -> int:
    with simulator(directory, "--only", "base") as process:
        hello = hello_of(directory / "ports" / "base")
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
    return hello.boot_id


def test_a_new_run_is_a_new_boot_of_the_same_board(tmp_path: Path) -> None:
    assert boot_id_of(tmp_path) + 1 == boot_id_of(tmp_path)


def test_it_can_be_one_board_alone(tmp_path: Path) -> None:
    with simulator(tmp_path, "--only", "joystick"), SimulatorClient(tmp_path / "control") as client:
        assert set(client.state().boards) == {"joystick"}
        assert client.state().base is None
        with pytest.raises(SimulatorError, match="no base board here"):
            client.unplug("base")


def test_it_ends_with_its_parent(tmp_path: Path) -> None:
    start = (
        "import os, subprocess, sys, time\n"
        "child = subprocess.Popen([*sys.argv[1:], '--parent-pid', str(os.getpid())], stdout=subprocess.PIPE)\n"
        "child.stdout.readline()\n"
        "print(child.pid, flush=True)\n"
        "time.sleep(600)\n"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", start, *command(tmp_path, "--only", "ranger")],
        stdout=subprocess.PIPE,
        text=True,
        env=environment(),
    )
    assert parent.stdout is not None
    assert int(parent.stdout.readline()) > 0
    assert (tmp_path / "control").exists()
    parent.kill()
    parent.communicate()
    wait(lambda: not (tmp_path / "control").exists(), 60.0, what="the simulator's end, without its parent")


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (["--world", "/nowhere.toml"], "/nowhere.toml: cannot be read"),
        (["--hand", "/nowhere.csv"], "/nowhere.csv: cannot be read"),
        (["--only", "base,motor"], "there is no board 'motor'"),
        (["--boards", "real"], "invalid choice: 'real'"),
    ],
)
def test_a_mistake_is_told_and_ends_it(tmp_path: Path, more: list[str], complaint: str) -> None:
    ended = subprocess.run(
        command(tmp_path, *more), capture_output=True, text=True, env=environment(), timeout=60, check=False
    )
    assert ended.returncode != 0
    assert complaint in ended.stderr
    assert "Traceback" not in ended.stderr
