"""The world around a robot of each kind, the disk that its encoders read, and the judge of its body."""

import os
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, assert_never

from giraff_base.config import BaseConfig, DriveConfig
from giraff_base.drives.balancer.config import BalancerConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.encoder_disk import LONGEST, Edge, Pattern, read_pattern
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import load, path_of, read_tables
from giraff_ranger.config import RangerConfig
from giraff_schemas.boards import BoardType
from giraff_schemas.services import BASE, RANGER
from giraff_sim.bodies.balancer.body import KNOWN as BALANCER_KNOWN
from giraff_sim.bodies.balancer.body import BalancerBody
from giraff_sim.bodies.balancer.drawn import Drawn as BalancerDrawn
from giraff_sim.bodies.balancer.drawn import draw
from giraff_sim.bodies.balancer.judge import BalancerJudge
from giraff_sim.bodies.wheels.body import KNOWN as WHEELS_KNOWN
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.bodies.wheels.judge import WheelsJudge
from giraff_sim.config import SimConfig
from giraff_sim.truth import EXACT, Truth
from giraff_sim.world.body import Body, BodyJudge
from giraff_sim.world.hand import Hand
from giraff_sim.world.room import Room
from giraff_sim.world.world import STEP_US, World

DrawnBody = BalancerDrawn
"""Difference between body and file, of each kind that has a `drawn` of its own."""

_DIVIDER: Final = "__BATTERY_VOLTS_PER_COUNT"


def read_drive(environment: Mapping[str, str] = os.environ) -> DriveConfig:
    """Return the drive that the robot file names. A simulated board needs no port of it. Raises ConfigError."""
    return load(BASE.table, BaseConfig, environment, port="simulated").drive


def read_ranger(environment: Mapping[str, str] = os.environ) -> BoardType:
    """Return the ranger's board that the robot file names. A simulated one needs no port of it. Raises ConfigError."""
    return load(RANGER.table, RangerConfig, environment, port="simulated").board_type


def with_known(environment: Mapping[str, str]) -> dict[str, str]:
    """Add the variables that a simulated robot of this kind brings, where neither file nor environment set the field.

    A divider of 0 is one that was not measured, so it is not set either. Raises ConfigError.
    """
    known, given = _known_of(read_drive(environment)), read_tables(environment)
    return {**environment, **{name: value for name, value in known.items() if not _has(given, name)}}


def _known_of(drive: DriveConfig) -> Mapping[str, str]:
    match drive:
        case WheelsConfig():
            board = drive.board_type
            left_out = {_DIVIDER: not board.measures_battery, "__WHEEL_CONTROL": board.loop_hz > 0}
            ends = tuple(end for end, is_left_out in left_out.items() if is_left_out)
            return {name: value for name, value in WHEELS_KNOWN.items() if not name.endswith(ends)}
        case BalancerConfig():
            return BALANCER_KNOWN
        case _ as never:
            assert_never(never)


def _has(tables: Any, variable: str) -> bool:
    """Return whether these tables have the field that a variable sets."""
    for name in path_of(variable):
        if not isinstance(tables, Mapping) or name not in tables:
            return False
        tables = tables[name]
    return bool(tables) or not variable.endswith(_DIVIDER)


def world_of(
    room: Room,
    robot: RobotConfig,
    drive: DriveConfig,
    sim: SimConfig,
    hand: Hand,
    seed: int,
    step_us: int = STEP_US,
    truth: Truth = EXACT,
) -> World:
    """Set the robot of the file at rest at the room's start. Raises ValueError for a disk that cannot be read."""
    body: Body
    disk = read_disk(sim.encoder_disk) if sim.encoder_disk else None
    match drive:
        case WheelsConfig() as wheels:
            body = WheelsBody(robot, wheels, sim, room, truth)
            body.disks = (disk, mirrored(disk)) if disk else ()  # base boards have encoder 1 mirrored
        case BalancerConfig() as balancer:
            drawn = draw(balancer, robot.track_width, seed, 0.0 if truth == EXACT else 1.0)
            body = BalancerBody(robot, balancer, room, seed, drawn)
            body.disks = (disk, disk) if disk else ()
        case _ as never:
            assert_never(never)
    return World(room, robot, body, sim, hand, seed, step_us, truth)


def judge_of(body: Body, robot: RobotConfig, config: BaseConfig, outlives_us: int) -> BodyJudge:
    """Return the judge of a body. `outlives_us`: for so long a frame may have effect."""
    match config.drive:
        case WheelsConfig():
            assert isinstance(body, WheelsBody), "a body is of its drive's kind"  # noqa: S101
            return WheelsJudge(body, robot, config, outlives_us)
        case BalancerConfig():
            assert isinstance(body, BalancerBody), "a body is of its drive's kind"  # noqa: S101
            return BalancerJudge(body, robot, outlives_us)
        case _ as never:
            assert_never(never)


def read_disk(path: str) -> Pattern:
    """Return the edges of the drawing in a file, the same that is printed for a real robot. Raises ValueError.

    They begin where both channels are low.
    """
    try:
        with Path(path).open("rb") as file:
            text = file.read(LONGEST + 1).decode()  # a little more than is read, so that a longer file is refused
        return _from_low(read_pattern(text))
    except OSError as error:
        raise ValueError(f"encoder_disk of [sim]: {path} cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        reason = "it is no text" if isinstance(error, UnicodeDecodeError) else error
        raise ValueError(f"encoder_disk of [sim]: {path}: {reason}") from error


def mirrored(pattern: Pattern) -> Pattern:
    """Return the edges of a disk that turns the other way, for the encoder whose channel B a base board has inverted.

    The board's mirrored wiring inverts B for a motor that looks the other way. B is inverted here as well, so that the
    pins have the levels of the disk.
    """
    states, edges = pattern
    before = [edges[-1], *edges]
    turned = [Edge(-edge.at % 1.0, left.a, not left.b) for left, edge in pairwise(before)]
    return _from_low(Pattern(states, tuple(sorted(turned))))


def _from_low(pattern: Pattern) -> Pattern:
    """Begin the turn where both channels become low, as the pins of a board are at its start, if they ever do."""
    states, edges = pattern
    first = next((edge.at for edge in edges if not (edge.a or edge.b)), edges[0].at)
    return Pattern(states, tuple(sorted(edge._replace(at=(edge.at - first) % 1.0) for edge in edges)))
