"""`giraff check wheels` on the real firmware: a wiring that nobody told it of is found, proved and written."""

import subprocess
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

import pytest

from giraff_schemas.wire import Wiring
from giraff_setup.wheels.wiring import SIDES
from giraff_sim.board import ROOT
from giraff_sim.control.client import SimulatorClient
from tests.support.elsewhere import GIRAFF, clean
from tests.support.process_robot import PATIENCE, PROVING_ROOM, ProcessRobot


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    """Simulator and boards, and no service."""
    directory = tmp_path_factory.mktemp("robot")
    world = directory / "world.toml"
    world.write_text(PROVING_ROOM)
    made = ProcessRobot(directory, world, "avr")
    yield made
    made.close()


@pytest.fixture
def robot(running: ProcessRobot) -> ProcessRobot:
    """Nothing is unplugged, cut, or soldered in another way."""
    running.simulator.rewire(Wiring(0))
    running.simulator.cut_encoder("left", cut=False)
    running.simulator.plug("base")
    return running


@pytest.fixture
def robot_file(tmp_path: Path) -> Path:
    """Of a robot that nobody has checked."""
    path = tmp_path / "robot.toml"
    path.write_bytes((ROOT / "deploy" / "robot.toml").read_bytes())
    return path


def check(robot: ProcessRobot, robot_file: Path) -> subprocess.Popen[str]:
    environment = clean(robot.environment) | {
        "GIRAFF_CONFIG": str(robot_file),
        "GIRAFF_BASE_PORT": str(robot.ports / "base"),
        "PYTHONUNBUFFERED": "1",
    }
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [str(GIRAFF), "check", "wheels"], env=environment, stdin=pipe, stdout=pipe, stderr=pipe, text=True
    )


def answers(wiring: Wiring) -> str:
    """Of somebody who looks at a robot that is soldered like this."""
    said = ["lifted"]
    for motor in (0, 1):
        wheel = motor ^ int(Wiring.SWAP_MOTORS in wiring)
        inverted = Wiring[f"INVERT_{SIDES[wheel].upper()}_MOTOR"] in wiring
        said += [SIDES[wheel], "backward" if inverted else "forward"]
    return "\n".join([*said, "yes", "yes", ""])


@pytest.mark.parametrize(
    "wiring",
    [
        Wiring.SWAP_MOTORS | Wiring.INVERT_LEFT_ENCODER | Wiring.SWAP_ENCODERS,
    ],
)
def test_a_wiring_is_found_proved_and_written(robot: ProcessRobot, robot_file: Path, wiring: Wiring) -> None:
    robot.simulator.rewire(wiring)
    with check(robot, robot_file) as process:
        out, err = process.communicate(answers(wiring), timeout=PATIENCE)
    assert (process.returncode, err) == (0, ""), out
    table = tomllib.loads(robot_file.read_text(encoding="utf-8"))["base"]["drive"]
    found = {bit for bit in Wiring if bit.name is not None and table[bit.name.lower()]}
    assert found == {bit for bit in Wiring if bit in wiring}
    assert not robot.drives()
    says = robot.simulator.state().base
    assert says is not None
    assert says.latch == "none", "a latch of the check is left behind"


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda simulator: simulator.cut_encoder("left", cut=True), "the left wheel turned and no encoder counted"),
        (lambda simulator: simulator.unplug("base"), "no such port"),
    ],
)
def test_any_trouble_writes_nothing(
    robot: ProcessRobot, robot_file: Path, spoil: Callable[[SimulatorClient], int], told: str
) -> None:
    before = robot_file.read_bytes()
    spoil(robot.simulator)
    with check(robot, robot_file) as process:
        _, err = process.communicate(answers(Wiring(0)), timeout=PATIENCE)
    assert process.returncode in (1, 2)
    assert told in err
    assert "Nothing was written" in err
    assert robot_file.read_bytes() == before


def test_beside_a_running_base_it_does_not_begin(robot: ProcessRobot, robot_file: Path) -> None:
    accepted = robot.accepted() + 50  # the last frames of the check before may not have been told yet
    robot.start("base")
    robot.wait("base at work", lambda: robot.accepted() > accepted, PATIENCE)
    began_us = robot.simulator.now()
    with check(robot, robot_file) as process:
        _, err = process.communicate(answers(Wiring(0)), timeout=PATIENCE)
    assert process.returncode == 2
    assert "in use by another process; end that one; giraff_base must not run meanwhile" in err
    assert robot.simulator.record(began_us).driven_ms == 0
    robot.stop("base")


def read_until(stream: IO[str] | None, words: str) -> None:
    assert stream is not None
    said = ""
    while words not in said:
        character = stream.read(1)
        assert character, f"it ended after {said!r}"
        said += character


def test_interrupted_while_a_wheel_turns_it_stops_it(robot: ProcessRobot, robot_file: Path) -> None:
    before = robot_file.read_bytes()
    with check(robot, robot_file) as process:
        assert process.stdin is not None
        process.stdin.write("lifted\n")
        process.stdin.flush()
        read_until(process.stdout, "Look at both.")
        robot.wait("a turning wheel", robot.drives, PATIENCE)
        process.terminate()
        _, err = process.communicate(timeout=PATIENCE)
        ended_us = robot.simulator.now()
    assert process.returncode == 130
    assert "interrupted; the motors are off. Nothing was written." in err
    robot.run(0.5)
    assert robot.simulator.record(ended_us + 20_000).driven_ms == 0
    assert robot_file.read_bytes() == before
