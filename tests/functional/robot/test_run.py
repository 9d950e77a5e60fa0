"""`giraff run` as people and scripts use it: a drive, a child that dies, a name that is taken."""

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from giraff_core.network import NetworkConfig
from giraff_node.network.session import open_session
from giraff_schemas.services import SIMULATED
from giraff_schemas.topics import TRUE_POSE, alive_key
from giraff_sim.board import ROOT
from giraff_sim.truth import Truth, TruthRanges, draw_truth
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.ports import free_port
from tests.support.keyboard_user import hold, take
from tests.support.process_robot import PATIENCE
from tests.support.runs import GIRAFF, PROCESSES, SMALL_ROOM, Command, command_in, line_of
from tests.support.terminals import screen

BACK_AND_FORTH = "t,x,y,z\n0,0,0,9.81\n" + "".join(
    f"{at + 1},0,0,9.81\n{at + 1.3},{tilt},0,8.4\n{at + 3.7},{tilt},0,8.4\n{at + 4},0,0,9.81\n"
    for at, tilt in zip(range(0, 480, 4), (5, -5) * 60, strict=True)
)
"""A hand that is level again and again: what has been stopped goes on."""
LASER = '{ type = "ld19", x = 0.05, y = 0.0, yaw = 0.4, own = [] }'


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    with command_in(tmp_path) as made:
        yield made


def test_it_drives_around_the_room_and_sums_up_when_told_to_end(command: Command) -> None:
    command.environment["GIRAFF_ROBOT_SENSORS__LASER"] = LASER
    with command.start("--truth", "exact", "--summary", "summary.json") as process:
        for _ in range(2):
            command.wait_until_it_drives(process, more=1)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")
    assert command.leaves_nothing()
    told = command.summary()
    assert told["truth"] == "exact"
    assert (told["seed"], told["failures"]) == (1, [])
    assert (told["contacts"], told["line_errors"]) == (0, 0)
    assert told["closest_m"] > 0.1
    assert told["odom_error_m"] < 0.02
    assert told["odom_error_deg"] < 1.0
    assert told["odom_sigma_m"] > 0.0
    assert f"distance  {told['distance_m']:.2f} m" in out
    assert "odometry off by" in out
    # Ten turns for a hundred samples of the wheels, also where a busy machine holds the world up.
    assert told["rates_hz"]["scan/laser"] > 0.07 * told["rates_hz"]["wheels"]


def test_who_starts_it_drives_in_the_same_terminal(command: Command) -> None:
    summary = str(command.directory / "summary.json")
    words = [str(GIRAFF), "run", "--local", "--boards", "host", "--hand", "keyboard", "--summary", summary]
    errors = command.directory / "errors"
    with screen(words, errors, command.environment | {"TERM": "xterm"}) as shown:
        shown.wait_for("nobody's: press an arrow key", PATIENCE)
        take(shown)
        seconds, told = 0, ""
        for _ in range(12):
            shown.forget()
            hold(shown, b"w", 1.0)
            told = shown.read()
            if "not armed" in told or "nobody's" in told:  # a busy machine stops it, and may disarm it
                take(shown)
            elif "the robot obeys" in told and (seconds := seconds + 1) == 2:
                break
        shown.type(b"\x03")  # for both
        assert shown.ended(PATIENCE) == 0, errors.read_text()
        assert shown.is_restored()
    assert errors.read_text() == ""
    assert command.leaves_nothing()
    assert command.summary()["distance_m"] > 0.1, told


def test_a_service_that_dies_is_named_and_the_others_go_on_until_their_world_ends(command: Command) -> None:
    (command.directory / "script.csv").write_text(BACK_AND_FORTH)
    (command.directory / "world.toml").write_text(SMALL_ROOM)
    options = ["--boards", "host", "--seed", "7", "--tilt-script", "script.csv", "--world", "world.toml"]
    with command.start(*options, "--summary", "summary.json") as process:
        line_of(process, "base driving")
        os.kill(command.pid("giraff_node odometry"), signal.SIGKILL)
        for _ in range(2):  # the first may be from before
            line_of(process, "base driving")  # losing odometry changes no motion
        os.kill(command.pid("giraff_sim"), signal.SIGKILL)
        _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert "odometry ended by itself (killed, SIGKILL): it was ended from outside: " in err
    assert "simulator ended by itself (killed, SIGKILL)" in err
    told = command.summary()
    assert told["odom_error_m"] is None
    assert len(told["failures"]) == 2
    assert (told["boards"], told["seed"], told["truth"]) == ("host", 7, "calibrated")
    assert msgspec.convert(told["drawn"], Truth) == draw_truth("calibrated", TruthRanges(), 7)
    [kept] = command.left.iterdir()
    assert f"the logs are in {kept}" in err
    assert {f"{name}.log" for name in ("simulator", *SIMULATED)} <= {file.name for file in kept.iterdir()}
    assert not command.pids()


def told_truth(command: Command) -> None:
    """Require that a command beside the run is told where the robot truly is, again and again."""
    asked = [str(GIRAFF), "topic", "echo", TRUE_POSE.key, "--count", "3", "--json"]
    told = subprocess.run(
        asked, env=command.environment, check=True, capture_output=True, text=True, timeout=PATIENCE
    ).stdout
    heard = [msgspec.json.decode(line)["sample"] for line in told.splitlines()]
    assert len({sample["instance"] for sample in heard}) == 1
    moments = [sample["tick"]["robot_ns"] for sample in heard]
    assert len(moments) == 3
    assert moments == sorted(set(moments))


def test_a_run_tells_the_truth_refuses_another_of_its_name_and_ends_when_its_reader_goes(command: Command) -> None:
    with command.start("--boards", "host", local=False) as process:
        line_of(process, " | ")
        told_truth(command)
        code, out, err = command.run(local=False)
        assert (code, out) == (2, "")
        assert f"a run of {command.robot} is going on on this host; end it, or give this one another name" in err
        assert len(command.pids()) == PROCESSES
        assert process.stdout is not None
        process.stdout.close()
        assert process.wait(PATIENCE) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""
    assert command.leaves_nothing()


def test_a_robot_of_the_same_name_on_the_network_is_refused(command: Command) -> None:
    elsewhere = f"127.0.0.1:{free_port()}"
    robot_file = command.directory / "robot.toml"
    settings = (ROOT / "deploy" / "robot.toml").read_text()
    robot_file.write_text(settings.replace("[network]", f'[network]\nconnect = ["{elsewhere}"]'))
    command.environment["GIRAFF_CONFIG"] = str(robot_file)
    other = RobotConnection(
        command.robot, open_session(NetworkConfig(rendezvous=elsewhere, local=True), command.robot, "door")
    )
    with other.session.liveliness().declare_token(alive_key(command.robot, "base", "there")):
        code, out, err = command.run("--for", "5", local=False)
    assert other.close()
    assert (code, out) == (2, "")
    assert f"a robot called {command.robot} is on the network already" in err
    assert "another name with GIRAFF_ROBOT_NAME" in err
    assert command.leaves_nothing()
