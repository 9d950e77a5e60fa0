"""What a run is to be: the options, checked, before anything is started."""

import math
import os
import socket
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args, get_type_hints

import tomlkit

from giraff_camera.config import CameraConfig, camera_of
from giraff_cli.run.demonstration import with_demonstration
from giraff_core.network import NetworkConfig
from giraff_core.robot import RobotConfig
from giraff_core.senses import PUBLISHERS
from giraff_guard.config import GuardConfig
from giraff_node.config.robot_file import ConfigError, load, robot_file
from giraff_node.network.discovery import resolve_target, simulated_name
from giraff_schemas.boards import BOARDS, RANGER_BOARD, BoardType
from giraff_schemas.services import DEMONSTRATION, SERVICES, SIMULATED
from giraff_schemas.topics import require_chunk
from giraff_schemas.wire import BoardKind
from giraff_sim.board import BUILD, ROOT, Implementation, files_of
from giraff_sim.bodies.registry import read_drive, read_ranger, with_known, world_of
from giraff_sim.config import SimConfig
from giraff_sim.main import make_hand
from giraff_sim.settings import Settings
from giraff_sim.truth import Level, draw_truth
from giraff_sim.world.hand import ScriptError
from giraff_sim.world.room import RoomError, read_room
from giraff_tools.network.ports import port_or_any
from giraff_vision.config import VisionConfig
from giraff_web.config import WebConfig

Boards = Literal["avr", "host"]
Hand = Literal["demo", "keyboard", "none"]


class PlanError(Exception):
    """Options that make no run. The message says which and why."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """The options of `giraff run`, as they were typed; its help says what each means."""

    file: Path | None
    seconds: float | None
    world: Path | None
    seed: int
    truth: Level
    tilt_script: Path | None
    hand: Hand
    boards: Boards | None
    summary: Path | None
    picture: Path | None
    web: bool
    localize: bool
    camera: bool
    local: bool


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A run that can begin."""

    options: Options
    robot: RobotConfig
    network: NetworkConfig
    """As the robot file has it; the run chooses the rendezvous."""
    environment: dict[str, str]
    """Of every process, but for what is known only at the start."""
    world: Path
    hand: str
    """The simulator's word for who holds the joystick."""
    boards: Boards
    why_boards: str
    """Reason for boards that are not the better ones, or not all of them. Empty where they are, or were asked for."""
    services: tuple[str, ...]
    """Names of those that run: of every run, and then of the options that were given."""
    camera: str
    """Name of the camera that is simulated; empty: none is."""


def make_plan(options: Options) -> Plan:
    """Return the plan. Raises PlanError."""
    seconds, tilt_script, hand = options.seconds, options.tilt_script, options.hand
    if seconds is not None and not (math.isfinite(seconds) and seconds > 0.0):
        raise PlanError(f"--for {seconds:g}: give a positive number of seconds, or leave it out to go on until Ctrl-C")
    if tilt_script is not None and hand != "demo":
        raise PlanError(f"--hand {hand} --tilt-script {tilt_script}: there is one joystick; leave one of the two out")
    if hand == "keyboard" and not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise PlanError(
            "--hand keyboard: there is no terminal to read keys from; start it in one, without a pipe, or with "
            "--hand none, and `giraff drive` in another"
        )
    try:
        environment = _environment(options)
        robot = load("robot", RobotConfig, environment)
        drive, ranger = read_drive(environment), read_ranger(environment)
        network = resolve_target(None, (), environment).network
        sim = load("sim", SimConfig, environment)
        _require_sound_services(environment)
        camera = _camera(robot, environment) if options.camera else ""
    except ConfigError as error:
        raise PlanError(str(error)) from error
    world = (options.world or ROOT / "deploy" / "worlds" / "living_room.toml").absolute()
    held_by = "still" if hand != "demo" else "demo" if tilt_script is None else str(tilt_script.absolute())
    try:
        room = read_room(world)
        drawn = draw_truth(options.truth, sim.truth, options.seed, robot.calibration)
        world_of(room, robot, drive, sim, make_hand(held_by, room, options.seed, 0.0), options.seed, truth=drawn)
    except RoomError as error:
        raise PlanError(f"--world: {error}") from error
    except ScriptError as error:
        raise PlanError(f"--tilt-script: {error}") from error
    except ValueError as error:
        raise PlanError(str(error)) from error
    for name in ("summary", "picture"):
        if (path := getattr(options, name)) is not None:
            _require_writable(f"--{name}", path)
    boards, why = choose_boards(options.boards, drive.board_type, BUILD, ranger)
    sensing = [PUBLISHERS[kind] for sense in robot.sensors.values() if (kind := sense.type_name()) in PUBLISHERS]
    asked = [service.name for service in SERVICES if service.option and getattr(options, service.option)]
    return Plan(
        options=options,
        robot=robot,
        network=network,
        environment=environment,
        world=world,
        hand=held_by,
        boards=boards,
        why_boards=why,
        services=tuple(dict.fromkeys((*SIMULATED, *sensing, *asked))),
        camera=camera,
    )


def choose_boards(
    wanted: Boards | None, base: BoardType, build: Path, ranger: BoardType = RANGER_BOARD
) -> tuple[Boards, str]:
    """The boards to run, and why they are not the real firmware where nobody asked for that."""
    missing: dict[Boards, list[str]] = {
        boards: [name for name in _needed(base, ranger, Implementation(boards)) if not (build / name).is_file()]
        for boards in get_args(Boards)
    }
    but_process = f"all but {base.name}, which is a process" if base.is_process else ""
    if wanted is not None:
        if missing[wanted]:
            raise PlanError(f"--boards {wanted}: build/{missing[wanted][0]} is missing; make run builds it")
        return wanted, but_process if wanted == "avr" else ""
    if not missing["avr"]:
        return "avr", but_process
    if not missing["host"]:
        return "host", f"build/{missing['avr'][0]} is missing (make run builds it where it can)"
    raise PlanError(f"there are no boards: build/{missing['host'][0]} is missing; make run builds it")


def _needed(base: BoardType, ranger: BoardType, implementation: Implementation) -> tuple[str, ...]:
    """Return the files that a robot with these boards is run from, below the build directory."""
    boards = {**BOARDS, BoardKind.BASE: base, BoardKind.RANGER: ranger}.values()
    return tuple(dict.fromkeys(name for board in boards for name in files_of(board, implementation)))


def _environment(options: Options) -> dict[str, str]:
    environment = dict(os.environ)
    if options.file is not None:
        environment["GIRAFF_CONFIG"] = str(options.file)
    environment.pop("WATCHDOG_USEC", None)  # nobody starts a service again that it ends
    if not environment.get("GIRAFF_CONFIG"):
        here = Path("deploy/robot.toml")
        environment["GIRAFF_CONFIG"] = str(here if here.is_file() else ROOT / "deploy" / "robot.toml")
    environment["GIRAFF_CONFIG"] = str(robot_file(environment).absolute())
    environment = with_known(environment)
    name = environment.setdefault("GIRAFF_ROBOT_NAME", simulated_name(socket.gethostname()))
    try:
        require_chunk(name)
    except ValueError as error:
        raise ConfigError(f"GIRAFF_ROBOT_NAME: {error}") from error
    if options.local:
        environment["GIRAFF_NETWORK_LOCAL"] = "true"
    priorities = with_demonstration(load("guard", GuardConfig, environment).priorities)
    table = tomlkit.inline_table()
    table.update(priorities)
    environment["GIRAFF_GUARD_PRIORITIES"] = table.as_string()
    environment["GIRAFF_JOYSTICK_OPERATOR"] = DEMONSTRATION
    # The simulated sensor sits straight, however a real one is glued.
    environment |= dict.fromkeys((f"GIRAFF_JOYSTICK_MOUNT_{angle}" for angle in ("ROLL", "PITCH", "YAW")), "0.0")
    # A hand that only lies there does not take the robot from nobody: `c` in `giraff drive` would be refused.
    environment["GIRAFF_JOYSTICK_ASKS_FROM_START"] = "true" if options.hand == "demo" else "false"
    if options.web:
        environment |= _page_settings(environment, local=options.local)
    return environment


def _require_sound_services(environment: Mapping[str, str]) -> None:
    """Raise ConfigError for what a service would refuse once it is started. The simulator gives the ports."""
    for table, config in get_type_hints(Settings).items():
        ports = {"port": "simulated"} if "port" in config.__struct_fields__ else {}
        load(table, config, environment, **ports)


def _camera(robot: RobotConfig, environment: Mapping[str, str]) -> str:
    """Return the name of the camera that the robot file means. Raises PlanError."""
    try:
        name, _ = camera_of(load("camera", CameraConfig, environment), robot)
        load("vision", VisionConfig, environment)
    except ValueError as error:
        raise PlanError(f"--camera: {error}") from error
    return name


def _page_settings(given: Mapping[str, str], *, local: bool) -> dict[str, str]:
    """Where the page is served: at the port that somebody has given, else at the usual one or any that is free."""
    config = load("web", WebConfig, given)
    port = config.port if "GIRAFF_WEB_PORT" in given else port_or_any(config.port)
    return {"GIRAFF_WEB_ADDRESS": "127.0.0.1" if local else config.address, "GIRAFF_WEB_PORT": str(port)}


def _require_writable(option: str, path: Path) -> None:
    path = path.resolve()
    if path.exists() and not path.is_file():
        raise PlanError(f"{option} {path}: is there already, and no plain file")
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise PlanError(f"{option} {path}: cannot be written: {error.strerror}") from error
