"""Where the robot is on a map: what giraff_localization says, what it is asked, and what it answers.

The frame `map` is the floor plan's own: m, x to the east and y to the north where the plan has them so.
"""

import math
from typing import Literal

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LocalizationState = Literal["no_map", "lost", "ambiguous", "told", "localized"]
"""`localized`: all that is known agrees on one place; `told`: somebody has given the place, and the sensors neither
confirm nor contradict it yet; `ambiguous`: several places explain what was heard; `lost`: none does yet, or not well
enough."""


class PlanarPose(msgspec.Struct, frozen=True, kw_only=True):
    """m, m, rad."""

    x: float
    y: float
    yaw: float
    """rad, in (-pi, pi]."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw)


class Candidate(PlanarPose, frozen=True, kw_only=True):
    """A place where the robot may be: `base_link` in `map`."""

    belief: float
    """Share of the particles' weight there, 0..1; 0: of a place that fits as well, and has no particles left."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw, self.belief)


class MapPose(Sample, frozen=True, kw_only=True):
    """Where the robot is on the map, and whether that is known: nobody may drive by it unless it is `localized`
    or `told`.

    Otherwise the pose is the best guess there is, or the last one. It is no part of what keeps the robot from
    obstacles.
    """

    state: LocalizationState
    x: float
    """m; `base_link` in `map`, at `tick`."""
    y: float
    yaw: float
    """rad, in (-pi, pi]."""
    covariance: tuple[float, float, float, float, float, float]
    """Of (x, y, yaw) of the best place: xx, xy, xyaw, yy, yyaw, yawyaw; m², m·rad, rad²."""
    odom: PlanarPose
    """Where the frame `odom` is in `map`: corrected now and then, while `odom` itself never jumps by that."""
    candidates: tuple[Candidate, ...]
    """Best first; empty where it is localized, and where there is no map."""
    explained: float
    """Share of the readings of the last metres that the best place explains, 0..1."""
    way: float
    """m driven since it was last known where the robot is, or since it began to look; 0 while it is localized."""
    particles: int
    map: str
    """Name of the floor plan; empty: there is none."""
    reason: Trouble = NO_TROUBLE
    """Cause, where the robot is not localized."""
    tick: RobotTime | None
    """Of the newest odometry in it; None: there was none yet."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw, self.explained, self.way, *self.covariance)

    @property
    def standard_deviations(self) -> tuple[float, float, float]:
        """Of x (m), y (m) and yaw (rad)."""
        xx, _, _, yy, _, tt = self.covariance
        return math.sqrt(max(0.0, xx)), math.sqrt(max(0.0, yy)), math.sqrt(max(0.0, tt))


class Particles(Sample, frozen=True, kw_only=True):
    """Some of the particles, drawn by their weights: for people who look at them."""

    x: tuple[float, ...]
    """m; `base_link` in `map`."""
    y: tuple[float, ...]
    yaw: tuple[float, ...]
    """rad"""

    def __post_init__(self) -> None:
        if not len(self.x) == len(self.y) == len(self.yaw):
            raise ValueError(f"{len(self.x)} x, {len(self.y)} y and {len(self.yaw)} yaw: each particle has all three")
        require_finite(self, *self.x, *self.y, *self.yaw)


class FreeCells(msgspec.Struct, frozen=True, kw_only=True):
    """Cells over a floor plan. Each tells whether the robot's middle can be there."""

    left: float
    """m, in `map`; x of the first cell's corner."""
    bottom: float
    """m; y of that corner."""
    side: float
    """m; of each cell."""
    columns: int
    """Cells along x."""
    rows: int
    """Cells along y."""
    bits: bytes
    """One bit for each cell: column after column, each upwards; the highest bit of a byte is first. 1: room."""

    def __post_init__(self) -> None:
        require_finite(self, self.left, self.bottom, self.side)
        if self.side <= 0.0 or min(self.columns, self.rows) < 0 or len(self.bits) != -(-self.columns * self.rows // 8):
            raise ValueError(f"{len(self.bits)} bytes for {self.columns} by {self.rows} cells of {self.side} m")

    def holds(self, x: float, y: float) -> bool:
        """Return whether the robot's middle can be at a place of `map`, m."""
        column, row = (x - self.left) / self.side, (y - self.bottom) / self.side
        if not (0.0 <= column < self.columns and 0.0 <= row < self.rows):
            return False
        byte, bit = divmod(int(column) * self.rows + int(row), 8)
        return bool(self.bits[byte] & 0x80 >> bit)

    def fault(self, x: float, y: float) -> Trouble:
        """Return why the robot cannot stand at a place of `map`, m."""
        if self.holds(x, y):
            return NO_TROUBLE
        right, top = self.left + self.columns * self.side, self.bottom + self.rows * self.side
        return Trouble(
            f"({x:g}, {y:g}) is in a wall, too near one, or off the map, which goes from ({self.left:.1f}, "
            f"{self.bottom:.1f}) to ({right:.1f}, {top:.1f}) m",
            "give a place where the robot can stand",
        )


class MapWalls(Sample, frozen=True, kw_only=True):
    """The floor plan that the robot is looked for on."""

    map: str
    """Its name."""
    walls: tuple[tuple[float, float, float, float], ...]
    """m; from x, y to x, y, in `map`."""
    free: FreeCells | None = None
    """Cells in which a robot of this size can stand. None: there is no map."""

    def __post_init__(self) -> None:
        for wall in self.walls:
            require_finite(self, *wall)


class LocalizationSetPose(msgspec.Struct, frozen=True, kw_only=True):
    """Tells where the robot is: m and rad, `base_link` in `map`. It moves nothing."""

    by: str
    id: int
    """Random, of this wish: asked again with the same one, it is not done again."""
    x: float
    y: float
    yaw: float
    """rad, any number of turns."""
    position_sd: float = 0.3
    """m; how sure that is, on either axis, as a standard deviation."""
    yaw_sd: float = 0.2
    """rad; the same of the heading."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw, self.position_sd, self.yaw_sd)
        if self.position_sd < 0.0 or self.yaw_sd < 0.0:
            raise ValueError(f"position_sd {self.position_sd} and yaw_sd {self.yaw_sd} must not be negative")


class LocalizationGlobal(msgspec.Struct, frozen=True, kw_only=True):
    """Asks to look for the robot anywhere on the map, from now on."""

    by: str
    id: int
    """As of `LocalizationSetPose`."""


class LocalizationAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """What localization did with either."""

    done: bool
    reason: Trouble = NO_TROUBLE
    """Cause of a refusal."""
