"""Options are checked before anything is started."""

import io
import math
import os
import socket
import sys
from inspect import signature
from pathlib import Path
from typing import Any

import pytest

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_cli.run.commands import run
from giraff_cli.run.plan import Options, Plan, PlanError, choose_boards, make_plan
from giraff_core.senses import Camera
from giraff_guard.config import GuardConfig
from giraff_joystick.config import JoystickConfig
from giraff_node.config.robot_file import load
from giraff_node.network.discovery import simulated_name
from giraff_schemas.boards import ARDROS_BOARD, BASE_BOARD, NANO_RANGER_BOARD, ROBOCLAW_BOARD
from giraff_schemas.services import SIMULATED
from giraff_schemas.topics import require_chunk
from giraff_schemas.trouble import NO_TROUBLE
from giraff_schemas.wire import Wiring
from giraff_sim.board import BUILD, ROOT
from giraff_sim.bodies.registry import read_drive, read_ranger, with_known
from giraff_sim.world.room import read_room
from giraff_web.config import WebConfig

BUILT = {
    "avr": ["lockstep/lockstep.so", "firmware/base.elf", "firmware/joystick.elf", "firmware/ranger.elf"],
    "host": ["host/base.so", "host/joystick.so", "host/ranger.so"],
}
ARDROS = ROOT / "deploy" / "robots" / "ardros.toml"


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No robot's settings, and nothing of the repository below the working directory."""
    for name in os.environ:
        if name.startswith("GIRAFF_"):
            monkeypatch.delenv(name)
    monkeypatch.chdir(tmp_path)


def typed(**options: Any) -> Options:
    """Return the options of `giraff run`: these, and of the others what the command line has for them."""
    return Options(**{name: each.default for name, each in signature(run).parameters.items()} | options)


def plan(**options: Any) -> Plan:
    return make_plan(typed(**options))


def test_the_defaults_make_a_run() -> None:
    made = plan()
    assert made.robot.name.startswith("sim-")
    assert made.environment["GIRAFF_ROBOT_NAME"] == made.robot.name
    assert Path(made.environment["GIRAFF_CONFIG"]) == ROOT / "deploy" / "robot.toml"
    assert made.world.is_file()
    assert (made.hand, made.services) == ("demo", SIMULATED)
    assert (made.boards, made.why_boards) == choose_boards(None, BASE_BOARD, BUILD)


def test_a_camera_is_simulated_where_the_robot_file_has_one() -> None:
    assert plan().camera == ""
    assert plan(camera=True).camera in plan().robot.of(Camera)
    with pytest.raises(PlanError, match="--camera: the robot file has no camera"):
        plan(camera=True, file=ARDROS)


@pytest.mark.parametrize(
    ("priorities", "lowest"), [("", -2), ("{}", -2), ("{ keyboard = 1, demo = 3 }", -2), ("{ keyboard = -7 }", -8)]
)
def test_the_demonstration_is_an_operator_below_everybody(
    monkeypatch: pytest.MonkeyPatch, priorities: str, lowest: int
) -> None:
    if priorities:
        monkeypatch.setenv("GIRAFF_GUARD_PRIORITIES", priorities)
    made = plan()
    assert made.environment["GIRAFF_JOYSTICK_OPERATOR"] == "demo"
    assert load("guard", GuardConfig, made.environment).priorities["demo"] == lowest


def test_the_simulated_sensor_sits_straight_however_the_real_one_is_glued(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIRAFF_JOYSTICK_MOUNT_YAW", "1.57")
    environment = plan().environment | {"GIRAFF_JOYSTICK_PORT": "/dev/joystick"}
    assert load("joystick", JoystickConfig, environment).mount_yaw == 0.0


@pytest.mark.parametrize(("hand", "asks"), [("demo", True), ("none", False)])
def test_a_hand_that_merely_lies_there_takes_the_robot_from_nobody(hand: str, asks: bool) -> None:
    made = plan(hand=hand)
    assert made.hand == ("demo" if asks else "still")
    environment = made.environment | {"GIRAFF_JOYSTICK_PORT": "/dev/joystick"}
    assert load("joystick", JoystickConfig, environment).asks_from_start == asks


def test_there_is_one_joystick(tmp_path: Path) -> None:
    with pytest.raises(PlanError, match=r"--hand none --tilt-script .*: there is one joystick"):
        plan(hand="none", tilt_script=tmp_path / "script.csv")


def test_a_keyboard_takes_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    with pytest.raises(PlanError, match=r"no terminal to read keys from; start it in one, .* or with --hand none"):
        plan(hand="keyboard")


def test_the_robot_may_be_named_and_kept_off_the_network(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIRAFF_ROBOT_NAME", "otto")
    made = plan(local=True)
    assert made.robot.name == "otto"
    assert made.network.local
    assert made.environment["GIRAFF_NETWORK_LOCAL"] == "true"


def test_the_robot_file_below_the_working_directory_counts_unless_another_is_given(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "deploy").mkdir()
    text = (ROOT / "deploy" / "robot.toml").read_text()
    (tmp_path / "deploy" / "robot.toml").write_text(text.replace("footprint_radius = 0.30", "footprint_radius = 0.25"))
    made = plan()
    assert made.robot.footprint_radius == 0.25
    assert Path(made.environment["GIRAFF_CONFIG"]) == tmp_path / "deploy" / "robot.toml"
    monkeypatch.setenv("GIRAFF_CONFIG", "deploy/robot.toml")
    (tmp_path / "mine.toml").write_text(text)
    made = plan(file=Path("mine.toml"))
    assert made.environment["GIRAFF_CONFIG"] == str(tmp_path / "mine.toml")
    assert (made.robot.name, made.robot.footprint_radius) == (simulated_name(socket.gethostname()), 0.30)


def test_a_simulated_robot_brings_what_neither_file_nor_environment_say(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file, text = tmp_path / "ardros.toml", ARDROS.read_text()
    file.write_text(text.replace('control = "speed"', 'control = "level"\ninvert_right_encoder = true'))
    monkeypatch.setenv("GIRAFF_BASE_DRIVE__SWAP_MOTORS", "true")
    environment = with_known({**os.environ, "GIRAFF_CONFIG": str(file)})
    drive = load("base", BaseConfig, environment).drive
    assert isinstance(drive, WheelsConfig)
    assert (drive.wheel_control, drive.wiring, drive.unchecked) == (
        "level",
        Wiring.INVERT_RIGHT_ENCODER | Wiring.SWAP_MOTORS,
        NO_TROUBLE,
    )
    assert load("guard", GuardConfig, environment).deceleration == 1.5
    file.write_text(file.read_text().replace("battery_volts_per_count = 0.01426", "battery_volts_per_count = 0.0"))
    drive = read_drive(with_known({"GIRAFF_CONFIG": str(file)}))
    assert isinstance(drive, WheelsConfig)
    assert drive.battery_volts_per_count == 0.03


def test_a_whole_table_of_the_environment_is_not_overruled(tmp_path: Path) -> None:
    file = tmp_path / "ardros.toml"
    file.write_text(ARDROS.read_text().replace('control = "speed"', 'control = "speed"\nswap_motors = true'))
    table = '{ type = "wheels", max_level = 70, stall_level = 25, battery_volts_per_count = 0, swap_encoders = true }'
    drive = read_drive(with_known({"GIRAFF_CONFIG": str(file), "GIRAFF_BASE_DRIVE": table}))
    assert (drive.wiring, drive.unchecked) == (Wiring.SWAP_ENCODERS, NO_TROUBLE)


def test_without_a_page_nothing_of_one_is_settled() -> None:
    assert [name for name in plan().environment if name.startswith("GIRAFF_WEB_")] == []


def page_of(**options: Any) -> WebConfig:
    return load("web", WebConfig, plan(web=True, **options).environment)


def test_a_page_has_the_files_port_or_any_where_somebody_has_that(tmp_path: Path) -> None:
    (tmp_path / "deploy").mkdir()
    shipped = (ROOT / "deploy" / "robot.toml").read_text()
    with socket.create_server(("", 0)) as held:
        port = held.getsockname()[1]
        (tmp_path / "deploy" / "robot.toml").write_text(shipped.replace("[web]", f"[web]\nport = {port}"))
        assert page_of().port == 0
    assert page_of().port == port


def test_a_port_that_somebody_has_given_is_not_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("", 0)) as held:
        port = held.getsockname()[1]
        monkeypatch.setenv("GIRAFF_WEB_PORT", str(port))
        assert page_of().port == port


def test_a_run_that_keeps_off_the_network_has_its_page_on_this_host_alone() -> None:
    assert page_of(local=True).address == "127.0.0.1"
    assert page_of(local=False).address == ""


def world_file(directory: Path, text: str) -> Path:
    path = directory / "world.toml"
    path.write_text(text)
    return path


ROOM = """
name = "closet"
start = { x = 0.0, y = 0.0, yaw_deg = 0.0 }
waypoints = [[1.0, 0.0]]
"""


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(-3.0, "--for -3"), (0.0, "--for 0"), (math.nan, "--for nan"), (math.inf, "--for inf")],
)
def test_a_run_lasts_a_positive_time(seconds: float, told: str) -> None:
    with pytest.raises(PlanError, match=told):
        plan(seconds=seconds)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("not toml", "--world: .*not TOML"),
        ("name = 'x'", "start"),
        (ROOM + "[[walls]]\nname = 'near'\npoints = [[0.1, -1.0], [0.1, 1.0]]", "does not fit"),
        (ROOM.replace("waypoints", "# waypoints"), "waypoints"),
    ],
)
def test_a_bad_world_is_refused(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(PlanError, match=told):
        plan(world=world_file(tmp_path, text))


def test_a_world_without_waypoints_is_good_enough_for_a_script(tmp_path: Path) -> None:
    script = tmp_path / "script.csv"
    script.write_text("t,x,y,z\n0,0,0,9.81\n2,4,0,9\n")
    made = plan(world=world_file(tmp_path, ROOM.replace("waypoints", "# waypoints")), tilt_script=script)
    assert made.hand == str(script)
    assert read_room(made.world).name == "closet"


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("0,0,0,9.81\n1,up,0,9.81", r"script\.csv:2: x is 'up'"),
        ("0,0,0,9.81\n1,0,0", r"script\.csv:2: 3 columns"),
        ("0,0,0,9.81\n1,nan,0,0", r"script\.csv:2: x is nan"),
        ("1,0,0,9.81\n0,0,0,9.81", r"script\.csv:2: time 0"),
        ("", "no row"),
    ],
)
def test_a_bad_tilt_script_is_refused_with_file_and_line(tmp_path: Path, rows: str, told: str) -> None:
    script = tmp_path / "script.csv"
    script.write_text(rows)
    with pytest.raises(PlanError, match=rf"--tilt-script: .*{told}"):
        plan(tilt_script=script)


@pytest.mark.parametrize("option", ["summary", "picture"])
def test_what_cannot_be_written_is_refused_at_the_start(tmp_path: Path, option: str) -> None:
    with pytest.raises(PlanError, match=rf"--{option} .*cannot be written: No such file"):
        plan(**{option: tmp_path / "missing" / "file"})
    with pytest.raises(PlanError, match=rf"--{option} .*no plain file"):
        plan(**{option: tmp_path})
    with pytest.raises(PlanError, match="no plain file"):
        plan(**{option: Path(os.devnull)})
    kept = tmp_path / "kept"
    kept.write_text("before")
    plan(**{option: kept})
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]
    assert kept.read_text() == "before"


@pytest.mark.parametrize(
    ("variable", "value", "told"),
    [
        ("GIRAFF_ROBOT_NAME", "a/b", "GIRAFF_ROBOT_NAME: 'a/b'"),
        ("GIRAFF_SPEED", "1", "GIRAFF_SPEED: names no field"),
        ("GIRAFF_CONFIG", "missing.toml", "no robot file"),
        ("GIRAFF_ROBOT_TRACK_WIDTH", "wide", "track_width"),
        ("GIRAFF_RANGER_PROT", "x", r"GIRAFF_RANGER_PROT of the environment.*: unknown field `prot`"),
    ],
)
def test_bad_settings_are_refused(monkeypatch: pytest.MonkeyPatch, variable: str, value: str, told: str) -> None:
    monkeypatch.setenv(variable, value)
    with pytest.raises(PlanError, match=told):
        plan()


def build(directory: Path, *boards: str) -> Path:
    for name in (name for kind in boards for name in BUILT[kind]):
        (directory / name).parent.mkdir(exist_ok=True)
        (directory / name).touch()
    return directory


def test_the_real_firmware_is_taken_where_it_is_built_and_what_was_asked_for_is_not_replaced(tmp_path: Path) -> None:
    with pytest.raises(PlanError, match="make run"):
        choose_boards(None, BASE_BOARD, tmp_path)
    boards, why = choose_boards(None, BASE_BOARD, build(tmp_path, "host"))
    assert (boards, "build/lockstep/lockstep.so is missing" in why) == ("host", True)
    with pytest.raises(PlanError, match=r"--boards avr: build/lockstep/lockstep\.so is missing; make run"):
        choose_boards("avr", BASE_BOARD, tmp_path)
    assert choose_boards(None, BASE_BOARD, build(tmp_path, "avr")) == ("avr", "")
    assert choose_boards("host", BASE_BOARD, tmp_path) == ("host", "")


def test_another_base_board_needs_its_own_firmware(tmp_path: Path) -> None:
    for name in ("firmware/ardros.elf", "host/ardros.so"):
        with pytest.raises(PlanError, match=f"--boards .*: build/{name} is missing"):
            choose_boards("avr" if name.endswith("elf") else "host", ARDROS_BOARD, build(tmp_path, "avr", "host"))
        (tmp_path / name).touch()
    (tmp_path / "firmware" / "base.elf").unlink()
    assert choose_boards(None, ARDROS_BOARD, tmp_path) == ("avr", "")
    (tmp_path / "host" / "roboclaw.so").touch()
    assert choose_boards("avr", ROBOCLAW_BOARD, tmp_path) == ("avr", "all but roboclaw, which is a process")
    assert choose_boards("host", ROBOCLAW_BOARD, tmp_path) == ("host", "")


def test_the_ranger_of_the_file_needs_its_own_firmware(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("giraff_cli.run.plan.BUILD", build(tmp_path, "avr"))
    assert plan(boards="avr").boards == "avr"
    monkeypatch.setenv("GIRAFF_RANGER_BOARD", "nano_ranger")
    with pytest.raises(PlanError, match=r"--boards avr: build/firmware/nano_ranger\.elf is missing"):
        plan(boards="avr")
    (tmp_path / "firmware" / "nano_ranger.elf").touch()
    assert read_ranger(plan(boards="avr").environment) is NANO_RANGER_BOARD


@pytest.mark.parametrize(
    ("host", "name"),
    [("vm", "sim-vm"), ("näh.kästchen local", "sim-n-h-k-stchen-local"), ("*", "sim-host"), ("", "sim-host")],
)
def test_any_host_has_a_name_for_its_simulation(host: str, name: str) -> None:
    assert simulated_name(host) == require_chunk(name)
