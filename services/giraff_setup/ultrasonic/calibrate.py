"""`giraff calibrate ranger`: ultrasonic sensors by a wall, from the first distance to the robot file."""

import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple, Protocol

import msgspec

from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_guard.setup import distances
from giraff_node.config.robot_file import ConfigError, load
from giraff_setup.ultrasonic.procedure import PINGS, Measured, Stand, StoppedError, looks, measure
from giraff_setup.ultrasonic.stand import NetworkStand
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.robot_file import (
    RobotFileError,
    Value,
    before_today,
    document,
    own_robot_file,
    record_all,
    rehearse,
    still_overriding,
)
from giraff_tools.terminal.document import INTERRUPTED, REFUSED, UNUSABLE, Report, complain, no_report, print_report
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, introduce, signals_interrupt
from giraff_tools.terminal.output import DONE

_complain: Final = partial(complain, "calibrate ranger")
_FIELDS: Final = ("x", "y", "z", "yaw", "scale")
_THEN: Final = "Nothing goes by it yet: copy the file to the robot's other machines, and restart its services at rest."
_NOTHING: Final = 0.0005
"""m. A smaller change of an obstacle's distance is none."""


class HeldRest(Stand, Protocol):
    """A robot before a wall whose motions hold a lease."""

    def wait_released(self) -> None:
        """Wait until giraff_motion has given the lease back. Raises StoppedError."""
        ...


def calibrate_ranger(robot: str | None, connect: Sequence[str], file: Path | None, *, as_json: bool = False) -> int:
    """Do the whole command; return its exit code. `file`: as of `own_robot_file`.

    `as_json`: the talk goes to standard error.
    """
    return lead("calibrate ranger", NetworkStand, guide, robot, connect, file, as_json=as_json)


def lead(
    command: str,
    stand_on: Callable[[RobotConnection], NetworkStand],
    guide: Callable[..., int],
    robot: str | None,
    connect: Sequence[str],
    file: Path | None,
    *,
    as_json: bool,
) -> int:
    """Do a calibration whose motions hold a lease; return its exit code. `file`, `as_json`: as `calibrate_ranger`.

    `guide`: takes the human, the stand, the robot as filed, the file's path, and where to report.
    """

    def act(connection: RobotConnection, report: Report) -> int:
        try:
            path, filed = own_robot_file(connection.robot, file)
            human = Terminal(sys.stdin, sys.stdout)
            stand = stand_on(connection)
            stand.place()
            introduce(human, connection.robot, path)
            return guide(human, stand, filed, path, report=report)
        except ConfigError as error:
            return complain(command, str(error), UNUSABLE)
        except StoppedError as error:
            return complain(command, f"{error}. Nothing was written.", UNUSABLE)

    def find_and_act(report: Report) -> int:
        with signals_interrupt():
            try:  # it writes into the file, so that no simulation stands in
                return run_with_robot(robot, connect, lambda it: act(it, report), moves=True, stands_in=False)
            except KeyboardInterrupt:
                return complain(command, "interrupted. Nothing was written.", INTERRUPTED)

    return print_report(find_and_act, as_json=as_json)


def guide(
    human: Human,
    stand: HeldRest,
    filed: RobotConfig,
    path: Path,
    pings: int = PINGS,
    report: Report = no_report,
) -> int:
    """Measure, tell, ask and write into `path`, which says `filed`; return the exit code. Raises ConfigError."""
    guard = load("guard", GuardConfig, {**os.environ, "GIRAFF_CONFIG": str(path)})
    sensors = filed.of(Ultrasonic).items()
    try:
        rehearse(path, {_table(name): {each: getattr(pose, each) for each in _FIELDS} for name, pose in sensors})
    except RobotFileError as error:
        return _complain(str(error), UNUSABLE)
    try:
        tables = _measure(human, stand, filed, pings)
        if not tables:
            return _complain("nothing was found. Nothing was written.", REFUSED)
        if not agrees(human, f"Write {', '.join(tables)} into {path}? [yes/no]"):
            return _complain("not wanted. Nothing was written.", REFUSED)
        now = filed
        for name, fields in list(tables.items()):
            then = placed(now, name, fields)
            words = warning(name, now, then, guard)
            if words and not agrees(human, f"{words} Write it all the same? [yes/no]"):
                human.show(f"{name} stays as it is.")
                del tables[name]
            else:
                now = then
        if not tables:
            return _complain("not wanted. Nothing was written.", REFUSED)
        stand.wait_released()
    except StoppedError as error:
        return _complain(f"{error}. Nothing was written.", REFUSED)
    except NobodyError:
        return _complain("nobody answers. Nothing was written.", UNUSABLE)
    return write(human, "calibrate ranger", tables, path, report)


def _measure(human: Human, stand: Stand, filed: RobotConfig, pings: int) -> dict[str, dict[str, float]]:
    """Return the fields to write of each sensor that was found."""
    tables, sensors = {}, filed.of(Ultrasonic)
    for name, measured in measure(human, stand, filed, pings).items():
        before = sensors[name]
        told = bounded(before, measured)
        human.show(in_words(before, name, told))
        if fields := changed(before, told):
            tables[name] = fields
    return tables


def write(human: Human, command: str, tables: Mapping[str, Mapping[str, Value]], path: Path, report: Report) -> int:
    """Write these sensors' fields all at once, and tell it; return the exit code."""
    named = {_table(name): fields for name, fields in tables.items()}
    try:
        kept = record_all(path, named, kept_as=before_today())
    except RobotFileError as error:
        return complain(command, str(error), REFUSED)
    report(document(path, named, kept))
    human.show(f"Written: {', '.join(tables)} in {path}; as it was before: {kept}. {_THEN}")
    if overriding := still_overriding(named, os.environ):
        human.show(overriding)
    return DONE


def _table(name: str) -> str:
    return f"robot.sensors.{name}"


def changed(before: Ultrasonic, measured: Measured) -> dict[str, float]:
    """Return the fields of the robot file that become others; none where nothing was found."""
    if (found := measured.found) is None:
        return {}
    filed = measured.filed
    ruled = {
        name: round(getattr(filed, name), 4) for name in ("y", "z") if getattr(filed, name) != getattr(before, name)
    }
    return {
        **ruled,
        "x": round(found.x, 4),
        "yaw": round(math.remainder(found.yaw, math.tau), 4),
        "scale": round(found.scale, 4),
    }


class Farther(NamedTuple):
    """m by which a sensor places an obstacle farther than before; negative: nearer."""

    sensor: str
    at_1_m: float
    """Straight ahead of the sensor."""
    most: float
    """At most within the sensor's reach, by anything that the guard judges it by."""


def placed(robot: RobotConfig, name: str, fields: Mapping[str, float]) -> RobotConfig:
    """Return the robot with these fields of one sensor."""
    sensor = msgspec.structs.replace(robot.sensors[name], **fields)
    return msgspec.structs.replace(robot, sensors={**robot.sensors, name: sensor})


def farther(before: RobotConfig, after: RobotConfig, guard: GuardConfig) -> Farther:
    """Compare all sensors as the guard judges them; return the one that places an obstacle farthest.

    Everything that is compared grows evenly with the echo and with the way since, so that the ends tell the most.
    """
    way = guard.range_budget * before.max_wheel_speed
    found = []
    for name, sensor in before.of(Ultrasonic).items():
        reach = min(guard.reach, sensor.reach)
        most = max(
            then - now
            for echo in (0.0, reach)
            for came in (0.0, way)
            for now, then in zip(
                distances(before, name, guard, echo, came), distances(after, name, guard, echo, came), strict=True
            )
        )
        now, then = (distances(robot, name, guard, 1.0, 0.0)[0] for robot in (before, after))
        found.append(Farther(name, then - now, most))
    return max(found, key=lambda each: each.most)


def warning(name: str, before: RobotConfig, after: RobotConfig, guard: GuardConfig) -> str:
    """Return what a person must agree to before obstacles are placed farther; empty: they are not.

    `name`: the sensor that is another in `after`.
    """
    sensor, at_1_m, most = farther(before, after, guard)
    if most <= _NOTHING:
        return ""
    return (
        f"{f'With {name} so, ' if sensor != name else ''}{sensor} will place an obstacle at 1 m "
        f"{abs(at_1_m) * 1000.0:.0f} mm {'farther' if at_1_m > 0.0 else 'nearer'} than now, and up to "
        f"{most * 1000.0:.0f} mm farther within its reach: the robot stops later before it."
    )


def in_words(before: Ultrasonic, name: str, measured: Measured) -> str:
    """Tell the person what was found of a sensor, how sure it is, and what was before."""
    if (found := measured.found) is None:
        return f"{name}: cannot be told, and stays as it is: {measured.why}."
    yaw, yaw_before = (math.degrees(math.remainder(angle, math.tau)) for angle in (found.yaw, before.yaw))
    rows = [
        ("x", f"{found.x:.3f} ± {found.x_sd:.3f} m", f"{before.x:.3f} m"),
        ("y", f"{measured.filed.y:.3f} m by ruler", f"{before.y:.3f} m"),
        ("z", f"{measured.filed.z:.3f} m by ruler", f"{before.z:.3f} m"),
        ("yaw", f"{yaw:.1f} ± {math.degrees(found.yaw_sd):.1f}°", f"{yaw_before:.1f}°"),
        ("scale", f"{found.scale:.4f} ± {found.scale_sd:.4f}", f"{before.scale:.4f}"),
    ]
    return "\n".join([f"{name:<14}{'found':<22}before", *(f"{what:<14}{now:<22}{was}" for what, now, was in rows)])


def bounded(before: Ultrasonic, measured: Measured) -> Measured:
    """Return what was measured, or why no robot file takes it."""
    try:
        after = msgspec.structs.replace(before, **changed(before, measured))
    except ValueError as error:
        return measured._replace(found=None, why=str(error))
    if looks(after) is not looks(before):
        return measured._replace(found=None, why="it would look more than 45° aside, where the guard does not count it")
    return measured
