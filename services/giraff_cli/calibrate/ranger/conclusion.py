"""What was found of the sensors, in words and as fields of the robot file; and when that needs a yes of its own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

import msgspec

from giraff_cli.calibrate.ranger.procedure import Measured
from giraff_core.robot import SensorPose
from giraff_core.sensors import UltrasonicModel

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


def farther(before: SensorPose, after: Mapping[str, float], model: UltrasonicModel) -> tuple[float, float]:
    """Return by how many m an obstacle is placed farther than before: at 1 m, and at most within the sensor's reach."""
    outward = (after["x"] - before.x) * math.copysign(1.0, math.cos(before.yaw))
    scale = after["scale"] - before.scale
    return outward + scale, max(outward, outward + scale * model.reach)


def warning(name: str, before: SensorPose, after: Mapping[str, float], model: UltrasonicModel) -> str:
    """Return what a person must agree to before obstacles are placed farther; empty: they are not."""
    at_1_m, most = farther(before, after, model)
    if most <= _NOTHING:
        return ""
    return (
        f"{name} will place an obstacle at 1 m {abs(at_1_m) * 1000.0:.0f} mm {'farther' if at_1_m > 0.0 else 'nearer'} "
        f"than now, and up to {most * 1000.0:.0f} mm farther within its reach: the robot stops later before it."
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
        msgspec.structs.replace(before, **changed(before, measured))
    except ValueError as error:
        return measured._replace(found=None, why=str(error))
    return measured
