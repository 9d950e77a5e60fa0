"""What localization says, in words, and how much of the way it said what."""

import math
from collections import defaultdict
from typing import Final, get_args

from giraff_schemas.localization import LocalizationState, MapPose

STATES: Final[tuple[LocalizationState, ...]] = get_args(LocalizationState)
"""From the least that is known to the most."""


def place_text(x: float, y: float, yaw: float) -> str:
    """m, m, rad of `map`."""
    return f"x {x:z.2f} y {y:z.2f} m, {math.degrees(yaw):z.1f}°"


def sigma_of(pose: MapPose) -> tuple[float, float]:
    """Standard deviations of the place (m) and of the heading (rad), by its own covariance."""
    x, y, yaw = pose.standard_deviations
    return math.hypot(x, y), yaw


def pose_text(pose: MapPose) -> str:
    """The state, where it has the robot, how sure that is, and why not surer."""
    if pose.state == "no_map":
        return " | ".join(["no map", *filter(None, [str(pose.reason)])])
    metres, radians = sigma_of(pose)
    guess = {"localized": "", "told": "about "}.get(pose.state, "perhaps ")
    parts = [
        pose.state if len(pose.candidates) < 2 else f"{pose.state}, {len(pose.candidates)} places",
        f"{guess}{place_text(pose.x, pose.y, pose.yaw)}",
        f"± {metres:.2f} m, {math.degrees(radians):.1f}°",
        f"explains {pose.explained:.0%}",
        f"way {pose.way:.1f} m",
        str(pose.reason),
    ]
    return " | ".join(filter(None, parts))


def short_pose_text(pose: MapPose) -> str:
    """The same in fewer words, for one line among others."""
    if pose.state == "no_map":
        return f"none: {pose.reason}"
    metres, radians = sigma_of(pose)
    place = f"{place_text(pose.x, pose.y, pose.yaw)} ± {metres:.2f} m, {math.degrees(radians):.0f}°"
    return f"{pose.state} {place}" if pose.state in ("localized", "told") else f"{pose.state}: {pose.reason}"


class WayByState:
    """How far the robot came in each state."""

    def __init__(self) -> None:
        self._metres: defaultdict[LocalizationState, float] = defaultdict(float)
        self._path: float | None = None

    def come(self, path: float, state: LocalizationState | None) -> None:
        """The robot has come `path` m by now, the last of it in `state`; None: it is not known. Way is never negative.

        A path that is shorter than before is another's: it begins anew.
        """
        if state is not None and self._path is not None and path > self._path:
            self._metres[state] += path - self._path
        self._path = path

    @property
    def shares(self) -> dict[LocalizationState, float] | None:
        """0..1 by state, those that came about; None: it has not moved."""
        whole = sum(self._metres.values())
        if not whole:
            return None
        return {state: self._metres[state] / whole for state in STATES if self._metres[state]}


def shares_text(shares: dict[LocalizationState, float] | None) -> str:
    """Like `lost 12 %, localized 88 % of the way`."""
    if not shares:
        return "it has not moved"
    return ", ".join(f"{state.replace('_', ' ')} {share:.0%}" for state, share in shares.items()) + " of the way"
