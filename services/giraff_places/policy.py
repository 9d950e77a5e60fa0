"""Decides whether the places count, and what a change makes of them. No I/O and no clock."""

import math
import shlex
from typing import Final, NamedTuple

from giraff_core.motion.map_pose import HeardMapPose
from giraff_core.robot import RobotConfig
from giraff_maps.floor_plan import FloorPlan
from giraff_maps.places_file import KnownPlaces
from giraff_places.route.planner import RoutePlanner
from giraff_schemas.localization import MapPose, MapWalls
from giraff_schemas.places import (
    LONGEST_NAME,
    MOST,
    NoGoLine,
    Place,
    PlaceAdd,
    PlaceChange,
    PlaceForbid,
    PlaceRemove,
    Places,
)
from giraff_schemas.text import brief, meant
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_SILENT: Final = 3.0
"""s without a sample after which localization, or another giraff_places, counts as gone."""
_LINE: Final = "line-"
_SHOWN: Final = 10
"""Names that are shown of those that there are."""

_UNHEARD: Final = Trouble(
    "localization is not heard", "wait 5 s where it has just begun, or check that giraff_localization runs"
)
_TWICE: Final = Trouble(
    "two processes keep the places of this robot", "see both with `giraff node list`, and stop one of them"
)
_FULL: Final = Trouble(f"{MOST} are there already, and no plan has more", "remove one")


class PlanFile(NamedTuple):
    """A floor plan, and the path of its file."""

    plan: FloorPlan
    path: str


class Changed(NamedTuple):
    """Places after a change."""

    name: str
    """Name of the place or line that it is about."""
    known: KnownPlaces


class PlacesPolicy:
    """Knows the places of one floor plan. Times are s of any one monotonic clock."""

    def __init__(self, source: PlanFile | Trouble, robot: RobotConfig) -> None:
        """`source`: the plan, or why there is none. Raises MapError for a plan that is too large."""
        self._source = source
        self.planner: RoutePlanner | None = None
        """None: there is no plan."""
        if isinstance(source, PlanFile):
            self.planner = RoutePlanner(source.plan, robot.footprint_radius, robot.passage_radius)
        self.known = KnownPlaces()
        self.file_fault = NO_TROUBLE
        """Cause, where the file of the places cannot be read now."""
        self._walls: MapWalls | None = None
        self._heard = HeardMapPose()
        self._shared = -math.inf
        """Moment when another giraff_places was last heard."""

    def on_map(self, walls: MapWalls) -> None:
        """Take the floor plan that localization goes by."""
        self._walls = walls

    def on_pose(self, pose: MapPose, now: float) -> None:
        """Take where the robot is."""
        self._heard.on_pose(pose, now)

    def on_other(self, now: float) -> None:
        """Take that another process keeps places of this robot, too."""
        self._shared = now

    @property
    def no_plan(self) -> Trouble:
        """Cause, where there is no floor plan."""
        return self._source if isinstance(self._source, Trouble) else NO_TROUBLE

    def places(self, now: float) -> Places:
        """Return what is to be told."""
        name = "" if isinstance(self._source, Trouble) else self._source.plan.name
        return Places(map=name, places=self.known.places, no_go=self.known.no_go, reason=self.reason(now))

    def reason(self, now: float) -> Trouble:
        """Return why the places count for nothing now."""
        if isinstance(self._source, Trouble):
            return self._source
        if now - self._shared <= _SILENT:
            return _TWICE
        return self.file_fault or self._plan_fault(self._source, now)

    def _plan_fault(self, source: PlanFile, now: float) -> Trouble:
        walls, pose = self._walls, self._heard.pose
        if dispute := self._heard.dispute(now):
            return dispute
        if walls is None or pose is None or now - self._heard.heard > _SILENT or pose.instance != walls.instance:
            return _UNHEARD
        if not walls.walls:
            return Trouble("localization has no floor plan", "", "run", "giraff localize --for 1")
        if (walls.map, walls.walls) != source.plan:
            return Trouble(
                f"localization goes by another floor plan, {brief(walls.map)}, than {source.path}",
                "give both the same `map` of [localization], and restart them",
            )
        return NO_TROUBLE

    def pose(self, now: float) -> MapPose | Trouble:
        """Return where the robot is, or why that is not known."""
        pose = self._heard.pose
        if (fault := self._heard.fault(now)) or pose is None:
            return fault
        return pose

    def goal(self, name: str) -> Place | Trouble:
        """Return the place of this name, or that there is none."""
        named = [place for place in self.known.places if place.name == name]
        return named[0] if named else _unknown("no place is called", name, [place.name for place in self.known.places])

    def changed(self, change: PlaceChange, now: float) -> Changed | Trouble:
        """Return what a change makes of the known places, or why it is refused."""
        source = self._source
        if isinstance(source, Trouble):
            return source
        if reason := self.reason(now):
            return reason
        try:
            match change:
                case PlaceAdd():
                    return self._added(change, now)
                case PlaceRemove():
                    return self._removed(change.name)
                case PlaceForbid():
                    return self._forbidden(change, source.plan)
        except ValueError as error:  # of a name, or of what is left when it is rounded
            return Trouble(str(error))

    def _added(self, change: PlaceAdd, now: float) -> Changed | Trouble:
        places, no_go = self.known
        if taken := self._taken(change.name):
            return taken
        if len(places) >= MOST:
            return _FULL
        pose = change.pose or self.pose(now)
        if isinstance(pose, Trouble):
            return pose
        x, y = _mm(pose.x), _mm(pose.y)
        degrees = round(math.degrees(math.remainder(pose.yaw, math.tau)), 1) + 0.0
        place = Place(name=change.name, x=x, y=y, yaw=math.remainder(math.radians(degrees), math.tau))
        if fault := self._standing_fault(x, y):
            return fault
        return Changed(place.name, KnownPlaces((*places, place), no_go))

    def _removed(self, name: str) -> Changed | Trouble:
        there = self._names()
        if name not in there:
            return _unknown("no place and no line is called", name, there)
        places = tuple(place for place in self.known.places if place.name != name)
        no_go = tuple(line for line in self.known.no_go if line.name != name)
        return Changed(name, KnownPlaces(places, no_go))

    def _forbidden(self, change: PlaceForbid, plan: FloorPlan) -> Changed | Trouble:
        places, no_go = self.known
        if len(no_go) >= MOST:
            return _FULL
        x, y, end_x, end_y = map(_mm, (change.x, change.y, change.end_x, change.end_y))
        left, bottom, right, top = plan.bounds
        if max(x, end_x) < left or min(x, end_x) > right or max(y, end_y) < bottom or min(y, end_y) > top:
            return Trouble(
                f"the line is off the map, which goes from ({left:.1f}, {bottom:.1f}) to ({right:.1f}, {top:.1f}) m",
                "give a line on it",
            )
        names = {*self._names()}
        name = next(f"{_LINE}{number}" for number in range(1, 2 * MOST + 2) if f"{_LINE}{number}" not in names)
        line = NoGoLine(name=name, x=x, y=y, end_x=end_x, end_y=end_y)
        return Changed(name, KnownPlaces(places, (*no_go, line)))

    def _names(self) -> list[str]:
        return [each.name for kind in self.known for each in kind]

    def _taken(self, name: str) -> Trouble:
        """Return what has this name already."""
        remove = f"giraff place remove {shlex.quote(name)}"
        for place in self.known.places:
            if place.name == name:
                return Trouble(f"{name} is a place already, at ({place.x:g}, {place.y:g}) m", "", "run", remove)
        if any(line.name == name for line in self.known.no_go):
            return Trouble(f"{name} is a no-go line already", "", "run", remove)
        return NO_TROUBLE

    def _standing_fault(self, x: float, y: float) -> Trouble:
        """Return why the robot cannot stand and turn there."""
        return NO_TROUBLE if self.planner is None else self.planner.place_fault(x, y)


def _unknown(what: str, name: str, there: list[str]) -> Trouble:
    others = meant(name, there) or (f"there are {', '.join(there[:_SHOWN])}" if there else "there are none yet")
    return Trouble(f"{what} {brief(name, LONGEST_NAME)}", others.strip())


def _mm(metres: float) -> float:
    return round(metres, 3) + 0.0  # no -0.0
