"""The outcome in words and as fields of the robot file, and the warning before obstacles are placed farther."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

import msgspec

from giraff_core.robot import RobotConfig, SensorPose
from giraff_guard.config import GuardConfig
from giraff_guard.setup import distances
from giraff_setup.ultrasonic.procedure import Measured, looks

_NOTHING: Final = 0.0005
"""m. A smaller change of an obstacle's distance is none."""


def changed(before: SensorPose, measured: Measured) -> dict[str, float]:
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
    return msgspec.structs.replace(
        robot, sensors={**robot.sensors, name: msgspec.structs.replace(robot.sensors[name], **fields)}
    )


def farther(before: RobotConfig, after: RobotConfig, guard: GuardConfig) -> Farther:
    """Compare all sensors as the guard judges them; return the one that places an obstacle farthest.

    Everything that is compared grows evenly with the echo and with the way since, so that the ends tell the most.
    """
    way = guard.range_budget * before.max_wheel_speed
    found = []
    for name in before.sensors:
        reach = min(guard.reach, before.model(name).reach)
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


def in_words(before: SensorPose, name: str, measured: Measured) -> str:
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


def bounded(before: SensorPose, measured: Measured) -> Measured:
    """Return what was measured, or why no robot file takes it."""
    try:
        after = msgspec.structs.replace(before, **changed(before, measured))
    except ValueError as error:
        return measured._replace(found=None, why=str(error))
    if looks(after) is not looks(before):
        return measured._replace(found=None, why="it would look more than 45° aside, where the guard does not count it")
    return measured
