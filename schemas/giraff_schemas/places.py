"""Places by name and lines that no route crosses, on a floor plan: what giraff_places says, is asked, and answers.

All is in the frame `map`, as localization has it.
"""

import math

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.localization import PlanarPose
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.motion import IDLE, MotionState
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LONGEST_NAME = 40
"""Characters of a place's name."""
FARTHEST = 10_000.0
"""m from (0, 0), where no plan has anything."""
MOST = 200
"""Places, and lines, of one plan."""


def require_place_name(name: str) -> str:
    """Return a name that a person can type after `giraff go`, where a point or a file may stand. Raises ValueError."""
    if not 0 < len(name) <= LONGEST_NAME or not name[0].isalpha() or name != name.strip():
        raise ValueError(f"{name[:50]!r} is no name: begin with a letter, and use {LONGEST_NAME} characters at most")
    if wrong := next((each for each in name if not (each.isalnum() or each in " -_")), ""):
        raise ValueError(f"{name!r} has {wrong!r} in it: use letters, digits, spaces, '-' and '_'")
    return name


class Place(PlanarPose, frozen=True, kw_only=True):
    """Pose of `base_link` in `map` that has a name."""

    name: str

    def __post_init__(self) -> None:
        require_place_name(self.name)
        require_finite(self, self.x, self.y, self.yaw)
        _require_near(self.x, self.y)


class NoGoLine(msgspec.Struct, frozen=True, kw_only=True):
    """A line, m, that no route crosses. The guard does not know it, and a hand drives over it."""

    name: str
    x: float
    y: float
    end_x: float
    end_y: float

    def __post_init__(self) -> None:
        require_place_name(self.name)
        require_line(self)


class Places(Sample, frozen=True, kw_only=True):
    """Places and lines of the floor plan that the robot is looked for on."""

    map: str
    """Name of the floor plan. Empty: there is none."""
    places: tuple[Place, ...]
    no_go: tuple[NoGoLine, ...]
    reason: Trouble = NO_TROUBLE
    """Cause, where the places count for nothing now: no plan, or localization goes by another one."""

    def are_on(self, plan: str) -> bool:
        """Return whether they count on the floor plan of this name."""
        return self.map == plan and not self.reason


class PlaceAdd(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="add"):
    """Give a place a name."""

    name: str
    pose: PlanarPose | None = None
    """None: where the robot is now, which must be known then."""


class PlaceRemove(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="remove"):
    """Remove a place, or a line."""

    name: str


class PlaceForbid(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="forbid"):
    """Draw a line that no route crosses, m in `map`. The answer has its name."""

    x: float
    y: float
    end_x: float
    end_y: float

    def __post_init__(self) -> None:
        require_line(self)


PlaceChange = PlaceAdd | PlaceRemove | PlaceForbid


class PlacesSet(msgspec.Struct, frozen=True, kw_only=True):
    """Asks for one change. It moves nothing."""

    by: str
    id: int
    """Random, of this wish: asked again with the same one, it is not done again."""
    change: PlaceChange


class PlacesAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Answer to a change."""

    done: bool
    """It counts, and is on disk."""
    name: str = ""
    """Name of the place or line."""
    reason: Trouble = NO_TROUBLE
    """Cause of a refusal."""


class Goal(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """End of a route, in `map`."""

    x: float
    """m; of `base_link`."""
    y: float
    yaw: float | None = None
    """rad; None: any heading will do."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw or 0.0)


class PlacesGo(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks for a route, and for the motions along it.

    Who asks says a `MotionHold` on `places/hold` once it is accepted, 25 times a second: without it nothing moves.
    """

    by: str
    id: int
    """Random, of this wish, never 0: asked again with the same one, nothing is begun again."""
    instance: str
    """Instance that the requester's `MotionHold` carries, never empty: nobody else's keeps the robot going."""
    tick: RobotTime
    """The newest that was heard when it was wished: an old request begins nothing."""
    goal: str | Goal
    """Name of a place, or a pose."""

    def __post_init__(self) -> None:
        if isinstance(self.goal, Goal):
            _require_near(self.goal.x, self.goal.y)


class RouteState(MotionState, frozen=True, kw_only=True):
    """State of a route, or the end of the last one until the next one begins.

    `asked` and `achieved` have the way alone: m that it takes from its start, and m that the robot has come. `step` is
    the leg, and `covariance` localization's.
    """

    place: str
    """Name of its goal; empty: it was given as a pose."""
    goal: Goal | None
    """None: there was no route yet."""
    corners: tuple[tuple[float, float], ...]
    """m, in `map`: from where the robot was as it was planned last to the goal, with a straight leg between two."""
    at: tuple[float, float] | None = None
    """m, in `map`: of what is in the way, or where it has ended; None: neither."""

    def __post_init__(self) -> None:
        way = (value for corner in self.corners for value in corner)
        require_finite(self, *self.covariance, self.elapsed, self.time_limit, *way, *(self.at or ()))


NO_ROUTE = RouteState(
    **{name: getattr(IDLE, name) for name in MotionState.__struct_fields__ if name not in Sample.__struct_fields__},
    place="",
    goal=None,
    corners=(),
)
"""Nobody has asked for a route yet."""


def require_line(line: NoGoLine | PlaceForbid) -> None:
    """Raise ValueError for a line with an end that is no number, or whose ends are one point."""
    require_finite(line, line.x, line.y, line.end_x, line.end_y)
    _require_near(line.x, line.y, line.end_x, line.end_y)
    if math.dist((line.x, line.y), (line.end_x, line.end_y)) < 0.01:
        raise ValueError("both ends of the line are one point: give two that are 0.01 m apart or more")


def _require_near(*metres: float) -> None:
    if max(map(abs, metres)) > FARTHEST:
        raise ValueError(f"a coordinate is beyond {FARTHEST:g} m from (0, 0): is it in metres?")
