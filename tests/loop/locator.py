"""In the place of giraff_localization, on a machine of its own or the robot's: it says what it is told to say."""

from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_core.timer import Timer
from giraff_localization.free_space import FreeSpace
from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.localization import LocalizationState, MapWalls
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.topics import MAP, ODOM, POSE
from giraff_sim.hosts.process import Process
from tests.support.map_poses import map_pose

ODOM_IN_MAP: Final = Pose(4.0, 1.0, 1.5)
_WALLS: Final = ((0.0, 0.0, 8.0, 0.0), (8.0, 0.0, 8.0, 5.0), (8.0, 5.0, 0.0, 5.0), (0.0, 5.0, 0.0, 0.0))
PLAN: Final = FloorPlan("flat", _WALLS)
_FREE: Final = FreeSpace(PLAN, 0.2).free


class Locator:
    """It knows where the robot is, by odometry alone."""

    link = None

    def __init__(self, process: Process) -> None:
        self.state: LocalizationState = "localized"
        self.odom = ODOM_IN_MAP
        """In `map`."""
        self.tick: RobotTime | None = None
        """That it says; None: the one of the newest odometry."""
        self._newest: Odometry | None = None
        self._odometry = process.inbox(ODOM, limit=1, wakes=False)
        self._poses, self._maps = process.publisher(POSE), process.publisher(MAP)
        self.timers = (Timer(POSE.rate_hz), Timer(MAP.rate_hz))

    @property
    def newest(self) -> RobotTime | None:
        """Of the odometry that it has heard."""
        return None if self._newest is None else self._newest.tick

    def turn(self, now: float) -> None:
        for odometry in self._odometry.pop_all():
            self._newest = odometry
        if self.timers[0].due(now) and (newest := self._newest) is not None:
            robot = Pose(newest.x, newest.y, newest.yaw)
            self._poses.put(map_pose(self.odom, robot, self.tick or newest.tick, self.state))

        if self.timers[1].due(now):
            self._maps.put(MapWalls(map="flat", walls=_WALLS, free=_FREE))

    def end(self) -> None:
        """Nothing is left to say."""
