"""Decides where the robot is, and whether that is known. No I/O and no clock.

A robot with a laser scanner in its file is found by that: its sonars are not used for the pose. Others are found by
their sonars.

What is to be computed is done in parts (`work`), so that nothing waits for it: where the robot is now, it tells at any
time, by the last update and by odometry since.
"""

import math
from collections import deque
from collections.abc import Iterator
from typing import Final

from giraff_core.bounds import Bounds
from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.dead_reckoning import wrapped
from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_localization.config import LocalizationConfig
from giraff_localization.filter import Filter
from giraff_localization.floor import Floor
from giraff_localization.given_pose import GivenPose
from giraff_localization.scan_search import ScanSearch
from giraff_localization.track import Track
from giraff_maps.floor_plan import FloorPlan, MapError
from giraff_schemas.frames import MAP_FRAME, ODOM_FRAME, Transform
from giraff_schemas.localization import (
    LocalizationAnswer,
    LocalizationGlobal,
    LocalizationSetPose,
    LocalizationState,
    MapPose,
    MapWalls,
    Particles,
    PlanarPose,
)
from giraff_schemas.messages import Odometry, Range
from giraff_schemas.scan import LaserScan
from giraff_schemas.trouble import NO_TROUBLE, Trouble

Search = Filter | ScanSearch
"""Has a pose and its covariance, the place on the track where it was `updated_at`, a judgement and what is `explained`,
a sample of what it follows, and takes samples and updates, in parts."""
_SHOWN: Final = 300
"""Particles."""
_REMEMBERED: Final = 64
"""Wishes that are met once."""
_SETTABLE: Final = {
    "position_sd": Bounds(0.0, 20.0, "m"),
    "yaw_sd": Bounds(0.0, math.pi, "rad"),
}
_ORIGIN: Final = Pose(0.0, 0.0, 0.0)
_NOWHERE: Final[Covariance] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_SILENT: Final = Trouble(
    "no odometry is heard", "check that giraff_odometry and giraff_base run, and the network to them"
)


class LocalizationPolicy:
    """Looks for one robot on one floor plan."""

    def __init__(
        self, config: LocalizationConfig, robot: RobotConfig, plan: FloorPlan | Floor | Trouble, seed: int = 0
    ) -> None:
        """`plan`: the map, or what was made of it already, or why there is none."""
        self._config, self._robot, self._seed = config, robot, seed
        floor = _floor(plan, config, robot)
        self._floor = floor if isinstance(floor, Floor) else None
        self._no_map = _read_so_far(0.0) if isinstance(floor, Floor) else floor
        self._building = None if self._floor is None else self._floor.build()
        self._search: Search | None = None
        self._updating: Iterator[None] | None = None
        self._track = Track()
        self._is_silent = False
        self._granted: deque[tuple[str, int]] = deque(maxlen=_REMEMBERED)
        self._searches = 0
        self._track_in_map = _ORIGIN
        """Pose of the track's frame in `map`."""
        self._transform: Transform | None = None

    def on_odometry(self, odometry: Odometry) -> None:
        """Take where the robot is in `odom`."""
        last = self._track.last
        self._track.on_odometry(odometry)
        if self._is_silent or last is None or last.segment != odometry.segment:
            self._is_silent = False
            self._update_transform()

    def on_sample(self, sample: Range | LaserScan) -> None:
        """Take what a sensor has heard."""
        if self._search is not None:
            self._search.on_sample(sample)

    def on_set_pose(self, request: LocalizationSetPose) -> LocalizationAnswer:
        """Take where somebody says that it is."""
        told = GivenPose(Pose(request.x, request.y, wrapped(request.yaw)), request.position_sd, request.yaw_sd)
        return self._begin_anew(("set_pose", request.id), told)

    def on_global(self, request: LocalizationGlobal) -> LocalizationAnswer:
        """Look for it anywhere."""
        return self._begin_anew(("global", request.id), None)

    def on_silence(self) -> None:
        """Odometry is not heard any more: until it is, nobody knows where the robot goes."""
        self._is_silent, self._transform = True, None

    @property
    def no_map(self) -> Trouble:
        """Why there is no map; NO_TROUBLE also while it is still read."""
        return self._no_map if self._floor is None else NO_TROUBLE

    def work(self) -> bool:
        """Do a part of what is to be computed, in some hundredths of a second; whether more may be left."""
        if self._floor is not None and self._building is not None:
            self._build(self._floor, self._building)
            return True
        if self._search is None:
            return False
        if self._updating is None:
            self._updating = self._search.update(self._track)
            return self._updating is not None
        if next(self._updating, self) is self:
            self._updating = None
            self._settle(self._search)
        return True

    def pose(self) -> MapPose:
        """Where it is now, by the last update and odometry since."""
        search, name = self._search, "" if self._floor is None else self._floor.plan.name
        here, odom = self._here, self._odom_in_map
        last, reason = self._track.last, self._reason
        judgement = None if search is None else search.judgement
        return MapPose(
            state=self._state,
            x=here.x,
            y=here.y,
            yaw=wrapped(here.yaw),
            covariance=_NOWHERE if search is None else search.covariance,
            odom=PlanarPose(x=odom.x, y=odom.y, yaw=wrapped(odom.yaw)),
            candidates=() if judgement is None else tuple(judgement.candidates),
            explained=0.0 if search is None else search.explained,
            way=0.0 if judgement is None else judgement.way,
            particles=0 if search is None else search.count,
            map=name,
            reason=reason,
            tick=None if last is None else last.tick,
        )

    def particles(self) -> Particles:
        """Some of them, as they were at the last update."""
        if self._search is None:
            return Particles(x=(), y=(), yaw=())
        x, y, yaw = self._search.sample(_SHOWN)
        return Particles(x=tuple(x.tolist()), y=tuple(y.tolist()), yaw=tuple(yaw.tolist()))

    def walls(self) -> MapWalls:
        """The map."""
        if self._floor is None:
            return MapWalls(map="", walls=())
        return MapWalls(map=self._floor.plan.name, walls=self._floor.plan.walls, free=self._floor.space.free)

    def transform(self) -> Transform | None:
        """Where `odom` is in `map`; None: that is not known. Safe to ask from any thread."""
        return self._transform

    @property
    def _state(self) -> LocalizationState:
        if self._search is None:
            return "no_map"
        return "lost" if self._is_silent else self._search.judgement.state

    @property
    def _reason(self) -> Trouble:
        if self._search is None:
            return self._no_map
        return _SILENT if self._is_silent else self._search.judgement.reason

    @property
    def _here(self) -> Pose:
        """`base_link` in `map`."""
        return self._track.pose.placed_in(self._track_in_map)

    @property
    def _odom_in_map(self) -> Pose:
        last = self._track.last
        if last is None:
            return _ORIGIN
        return _origin_in(self._here, Pose(last.x, last.y, last.yaw))

    def _build(self, floor: Floor, building: Iterator[float]) -> None:
        if (share := next(building, None)) is not None:
            self._no_map = _read_so_far(share)
            return
        self._building = None
        self._begin_search(floor, None)

    def _begin_anew(self, wish: tuple[str, int], told: GivenPose | None) -> LocalizationAnswer:
        if wish in self._granted:
            return LocalizationAnswer(done=True)
        if self._floor is None or self._search is None:
            return _refused(self._no_map)
        if told is not None and (refusal := _refusal(told, self._floor)):
            return _refused(refusal)
        self._granted.append(wish)
        self._begin_search(self._floor, told)
        return LocalizationAnswer(done=True)

    def _begin_search(self, floor: Floor, told: GivenPose | None) -> None:
        self._searches += 1
        if floor.walls is None:
            seed = self._seed + self._searches
            self._search = Filter(floor, self._config, self._robot, seed, self._track, told)
        else:
            self._search = ScanSearch(floor.space, floor.walls, self._robot, self._track, told)
        self._updating = None
        self._settle(self._search)

    def _settle(self, search: Search) -> None:
        """Go by what the search tells now."""
        self._track_in_map = _origin_in(search.pose, search.updated_at)
        self._update_transform()

    def _update_transform(self) -> None:
        last = self._track.last
        if self._state != "localized" or last is None:
            self._transform = None
            return
        odom = self._odom_in_map
        self._transform = Transform(
            parent=MAP_FRAME, child=ODOM_FRAME, x=odom.x, y=odom.y, yaw=wrapped(odom.yaw), fixed=False, tick=last.tick
        )


def _floor(plan: FloorPlan | Floor | Trouble, config: LocalizationConfig, robot: RobotConfig) -> Floor | Trouble:
    """What the filter needs of the map, or why there is none."""
    if not isinstance(plan, FloorPlan):
        return plan
    try:
        return Floor(plan, config, robot)
    except MapError as error:
        return Trouble(str(error))


def _read_so_far(share: float) -> Trouble:
    return Trouble(f"the map is being read: {share:.0%}", "wait")


def _refused(why: Trouble) -> LocalizationAnswer:
    return LocalizationAnswer(done=False, reason=why)


def _origin_in(frame: Pose, pose: Pose) -> Pose:
    """The origin of the frame in which the robot is at `pose`, given in the one in which it is at `frame`."""
    return _ORIGIN.seen_from(pose).placed_in(frame)


def _refusal(told: GivenPose, floor: Floor) -> Trouble:
    """Why the robot cannot be there."""
    try:
        for name, bounds in _SETTABLE.items():
            bounds.require(name, getattr(told, name))
    except ValueError as error:
        return Trouble(str(error))
    return floor.space.free.fault(told.pose.x, told.pose.y)
