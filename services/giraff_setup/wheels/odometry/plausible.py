"""Whether what was driven and measured can be what was asked for."""

import itertools
import math
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.calibration import Scales
from giraff_setup.wheels.odometry.plan import Leg
from giraff_setup.wheels.odometry.runs import Geometry, Run, path, travels, way

_EXPLAINED: Final = 0.10
"""Share by which wheels and track may differ from the robot file: far more than any that is measured at all."""
_UNLIKE: Final = 0.05
"""Share by which one wheel may differ from the other."""
_POSITION_SLACK: Final = 0.10  # m
_YAW_SLACK: Final = math.radians(10.0)
_STILL: Final = 0.02
"""m that the wheels have rolled, below which nothing was driven."""


class End(NamedTuple):
    """Where odometry has a run end, in the frame of its start."""

    x: float
    y: float
    yaw: float
    """rad, whole turns counted."""


def end(run: Run, geometry: Geometry) -> End:
    """By the scales of `geometry`."""
    return End(*map(float, path(run, geometry, geometry.scales)[-1]))


def length(run: Run, geometry: Geometry) -> float:
    """m that the robot's middle has gone, backwards counted too."""
    left, right = travels(run, geometry, geometry.scales)
    return float(np.sum(np.abs(left + right))) / 2.0


def driven_fault(leg: Leg, run: Run, geometry: Geometry) -> str:
    """Why this is not what the leg asks for; empty: it is."""
    if way(run, geometry)[-1] < _STILL:
        return "the wheels have not turned; is this the robot that you drive? `giraff why` says what stops it"
    gone, turned = length(run, geometry), end(run, geometry).yaw
    if not leg.path[0] <= gone <= leg.path[1]:
        return f"it went {gone:.2f} m, not {leg.path[0]:g} to {leg.path[1]:g}: {leg.task}"
    if not leg.turned[0] <= turned <= leg.turned[1]:
        least, most = (round(math.degrees(angle)) for angle in leg.turned)
        return f"it turned {math.degrees(turned):.0f} degrees (left positive), not {least} to {most}: {leg.task}"
    return ""


def measured_fault(run: Run, geometry: Geometry, x: float, y: float, yaw: float) -> str:
    """Why the robot cannot have ended here, however wrong its file is; empty: it can. `yaw`: whole turns counted."""
    ends = [end(run, geometry._replace(scales=scales)) for scales in _possible(geometry.scales)]
    for name, unit, slack, value, among in (
        ("ahead", "m", _POSITION_SLACK, x, [it.x for it in ends]),
        ("aside", "m", _POSITION_SLACK, y, [it.y for it in ends]),
        ("heading", "degrees", math.degrees(_YAW_SLACK), math.degrees(yaw), [math.degrees(it.yaw) for it in ends]),
    ):
        if min(among) - slack <= value <= max(among) + slack:
            continue
        why = "is its sign right, and were these marks those of this run?"
        if unit == "m" and abs(value) > 2.0 * (length(run, geometry) + 1.0):
            why = f"are these millimetres? Then type {value:g} mm"
        return (
            f"{name} is {value:g} {unit}, and by its wheels it can be {min(among):.2f} to {max(among):.2f} {unit}, "
            f"even with each {_EXPLAINED:.0%} off: {why}"
        )
    return ""


def _possible(scales: Scales) -> list[Scales]:
    return [
        Scales(
            scales.left_wheel * size * (1.0 - unlike), scales.right_wheel * size * (1.0 + unlike), scales.track * track
        )
        for size, unlike, track in itertools.product(
            (1.0 - _EXPLAINED, 1.0, 1.0 + _EXPLAINED),
            (-_UNLIKE / 2.0, 0.0, _UNLIKE / 2.0),
            (1.0 - _EXPLAINED, 1.0, 1.0 + _EXPLAINED),
        )
    ]
