"""Pose and its uncertainty from the travel of two wheels.

Between two readings each wheel is taken to turn at a constant speed, so that the robot's centre follows an arc. Its
chord is exact: no step size enters the pose.

The covariance follows R. Siegwart, I. Nourbakhsh, Introduction to Autonomous Mobile Robots, section 5.2.4: the
errors of the wheels' travels are independent, with variances that grow in proportion to the way each wheel has made,
whatever its direction, and are carried to the pose with the Jacobians of the step; here those of the arc. It grows
with distance and, since the wheels also travel while the robot turns on the spot, with turning. It stands for what is
random (slip, uneven floor). What is systematic (wheel diameters, track width) is `systematic_error`'s.
"""

import math
from typing import Final

import msgspec

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.differential_drive import DifferentialDrive

WHEEL_NOISE: Final = 1e-6
"""m: variance (m²) of a wheel's travel per metre of it, where nobody knows better."""
REVERSAL: Final = 0.01
"""m. Shorter ways back are no travel of the centre: the ticks of two wheels and their speed control make them."""
_SMALL: Final = 1e-4  # rad, of half a turn


class Estimate(msgspec.Struct, frozen=True, kw_only=True):
    """Where the robot is, how sure that is, and how far it has come."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    """rad, in (-pi, pi]."""
    covariance: Covariance = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """Of (x, y, yaw), of what is random: xx, xy, xyaw, yy, yyaw, yawyaw."""
    path: float = 0.0
    """m along the arcs of the centre, backwards counted too, but no way back that is shorter than `REVERSAL`."""
    back: float = 0.0
    """m. Way back from the farthest point of this direction, up to `REVERSAL`. `path` has not counted it."""
    direction: float = 1.0
    """1 while the robot makes its way forwards, -1 while it makes it backwards."""


def advance(start: Estimate, left: float, right: float, drive: DifferentialDrive, wheel_noise: float) -> Estimate:
    """`start` after the wheels have travelled `left` and `right` m; `wheel_noise`: m² of variance per metre."""
    distance, turn = drive.twist(left, right)
    ratio, ratio_slope = chord_ratio(turn), _chord_ratio_slope(turn)
    middle = start.yaw + turn / 2.0
    cos, sin = math.cos(middle), math.sin(middle)
    forward_x, forward_y = ratio * cos, ratio * sin  # d(x, y) / d(distance)
    turning_x = distance * (ratio_slope * cos - ratio * sin / 2.0)  # dx / d(turn)
    turning_y = distance * (ratio_slope * sin + ratio * cos / 2.0)
    step_x, step_y = distance * forward_x, distance * forward_y

    # A heading that was wrong before the step turns the step itself: F P F^T, dx/dyaw = -step_y, dy/dyaw = step_x.
    xx, xy, xt, yy, yt, tt = start.covariance
    xx, xy, xt, yy, yt = (
        xx - 2.0 * step_y * xt + step_y * step_y * tt,
        xy + step_x * xt - step_y * yt - step_x * step_y * tt,
        xt - step_y * tt,
        yy + 2.0 * step_x * yt + step_x * step_x * tt,
        yt + step_x * tt,
    )
    # G Q G^T, one column of G (dx, dy, dyaw per metre of that wheel) at a time.
    for travel, side in ((left, -1.0), (right, 1.0)):
        variance = wheel_noise * abs(travel)
        gx = forward_x / 2.0 + side * turning_x / drive.track_width
        gy = forward_y / 2.0 + side * turning_y / drive.track_width
        gt = side / drive.track_width
        xx += variance * gx * gx
        xy += variance * gx * gy
        xt += variance * gx * gt
        yy += variance * gy * gy
        yt += variance * gy * gt
        tt += variance * gt * gt

    ahead = start.direction * distance - start.back
    returns = ahead < -REVERSAL
    return Estimate(
        x=start.x + step_x,
        y=start.y + step_y,
        yaw=wrapped(start.yaw + turn),
        covariance=(xx, xy, xt, yy, yt, tt),
        path=start.path + (abs(ahead) if returns else max(0.0, ahead)),
        back=0.0 if returns else max(0.0, -ahead),
        direction=-start.direction if returns else start.direction,
    )


def less_sure(estimate: Estimate, position: float, yaw: float) -> Estimate:
    """The same place, with independent errors of these standard deviations (m on either axis, rad) added."""
    xx, xy, xt, yy, yt, tt = estimate.covariance
    covariance = (xx + position * position, xy, xt, yy + position * position, yt, tt + yaw * yaw)
    return msgspec.structs.replace(estimate, covariance=covariance)


def chord_ratio(turn: float) -> float:
    """Chord over arc of a turn: sin(turn/2) / (turn/2)."""
    half = turn / 2.0
    return math.sin(half) / half if abs(half) >= _SMALL else 1.0 - half * half / 6.0


def _chord_ratio_slope(turn: float) -> float:
    """Its derivative."""
    half = turn / 2.0
    if abs(half) < _SMALL:  # the closed form divides two vanishing numbers; the series is exact here
        return -half / 6.0
    return (math.cos(half) - math.sin(half) / half) / turn


def wrapped(angle: float) -> float:
    """`angle` in (-pi, pi]."""
    rest = math.remainder(angle, math.tau)
    return math.pi if rest == -math.pi else rest
