"""`giraff map make`: while somebody drives the robot, a plan grows in this terminal, which tells where the robot is."""

import math
import signal
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.io import IO
from giraff_core.kinematics.pose import Pose
from giraff_core.timer import Timer
from giraff_localization.config import LocalizationConfig
from giraff_maps.floor_plan import FloorPlan, MapError
from giraff_maps.scan.plan import MadePlan
from giraff_node import Node
from giraff_node.config.robot_file import ConfigError
from giraff_node.config.settings import Settings
from giraff_schemas.frames import MAP_FRAME, ODOM_FRAME, Transform
from giraff_schemas.localization import MapPose, MapWalls, PlanarPose
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.services import LOCALIZATION
from giraff_schemas.topics import MAP, ODOM, POSE, SCAN
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_setup.map.make.drive import NO_SCAN, Drive
from giraff_setup.map.make.finish import finish, wish_of
from giraff_setup.map.make.view import GrowingPlan, screen_of
from giraff_setup.map.make.words import now_text
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_limits
from giraff_tools.network.localization import require_none
from giraff_tools.terminal.output import discard_stdout
from giraff_tools.terminal.screen import Screen

_PATIENCE: Final = 10.0
"""s for the first scan that tells a place."""
_SILENCE: Final = 1.0
"""s without a scan that is worth a word."""
_DRAW_EVERY: Final = 3.0
"""s at least from the end of a plan to the begin of the next, and as long as the last one took."""
_DRAW: Final = 0.03
"""s of drawing in one turn."""
_LONGEST: Final = 0.1
"""s of scans in one turn."""
_SINCE_NS: Final = 1_000_000_000
_FARTHEST: Final = 1.0
"""ns and m from the newest turn within which odometry tells where the robot is."""
_SHOW_EVERY: Final = 0.2  # s
_COVARIANCE: Final = (0.03**2, 0.0, 0.0, 0.03**2, 0.0, 0.01**2)


def make(
    name: Path,
    robot: str | None,
    connect: Sequence[str],
    seconds: float | None,
    *,
    onto: bool,
    calibrate: bool,
    file: Path | None,
    as_json: bool,
) -> int:
    """Map until Ctrl-C, or for `seconds`; return the exit code. `onto`, `calibrate`, `file`: as of `Wish`."""
    try:
        wish = wish_of(name, onto=onto, calibrate=calibrate, file=file)
    except MapError as error:
        return print_error(str(error))

    def act(connection: RobotConnection) -> int:
        require_none(connection, "while a plan is made, this command tells where the robot is; end the other one first")
        limits = ask_limits(connection, "map make")
        try:
            wish.require_robot_file(connection.robot)
            drive = Drive(limits)
        except (MapError, ConfigError) as error:
            return print_error(str(error))
        # As of a door's client, which its session is: another address of this host must not begin the program anew.
        network = msgspec.structs.replace(connection.network, client=True)
        settings = Settings(LocalizationConfig(map=wish.stem.name), limits, network)
        with Node(LOCALIZATION.name, settings, session=connection.session) as node:
            signal.signal(signal.SIGHUP, lambda *_: node.leave())
            with closing(screen_of(as_json=as_json)) as screen:
                try:
                    making = PlanMaking(node, connection.robot, drive, wish.stem.name, screen, seconds, as_json=as_json)
                    node.run(making)
                except Exception as error:  # noqa: BLE001  what was driven is written, whatever it is
                    print_error(f"ended by {type(error).__name__}: {error}; what was driven is kept")
            return finish(drive, connection.robot, wish, as_json=as_json)

    return run_with_robot(robot, connect, act, moves=True)


class PlanMaking:
    """Reads `scan/*`; writes `pose` and `map`, as localization does, by the plan that grows."""

    link = None

    def __init__(
        self, io: IO, robot: str, drive: Drive, name: str, screen: Screen, seconds: float | None, *, as_json: bool
    ) -> None:
        """`name`: of the plan. `seconds`: until it ends. None: it goes on."""
        self._as_json = as_json
        self._io, self._robot, self._drive, self._name, self._screen = io, robot, drive, name, screen
        self._scans, self._odometry = io.inbox(SCAN), io.inbox(ODOM, wakes=False)
        self._newest: Odometry | None = None
        self._transform: Transform | None = None
        io.frame(ODOM_FRAME, lambda: self._transform)
        self._pose, self._map = io.publisher(POSE), io.publisher(MAP)
        self._pose_timer, self._map_timer, self._screen_timer = self.timers = (
            *(Timer(topic.rate_hz) for topic in (POSE, MAP)),
            Timer(1.0 / _SHOW_EVERY),
        )
        self._began = io.monotonic()
        self._until = self._began + (math.inf if seconds is None else seconds)
        self._heard = self._began
        self._plan: MadePlan | None = None
        self._walls: FloorPlan | None = None
        self._parts: Iterator[MadePlan | float] | None = None
        """A plan that is being made."""
        self._parts_began = self._next_plan = self._began
        self._drawn = 0
        """Key turns of the newest plan."""

    def turn(self, now: float) -> None:
        for scan in self._scans.pop_all():
            self._heard = now
            self._drive.add(scan)
            if self._io.monotonic() - now > _LONGEST:
                break
        for odometry in self._odometry.pop_all():
            self._newest = odometry
        if not len(self._scans):
            self._draw(now)
        self._transform = self._odom_frame()
        if self._pose_timer.due(now):
            self._pose.put(self._pose_sample(now))
        if self._map_timer.due(now):
            self._say_walls()
        if self._screen_timer.due(now):
            self._show(now)
        self._io.set_notice("scan", self._trouble(now))
        if now >= self._until or (not self._drive.mapper.keys and now - self._began > _PATIENCE):
            self._io.leave()

    def end(self) -> None:
        """Nothing is left to say."""

    def _draw(self, now: float) -> None:
        """Do a part of the next plan."""
        if self._parts is None:
            keys = len(self._drive.mapper.keys)
            if now < self._next_plan or keys == self._drawn:
                return
            self._parts, self._parts_began, self._drawn = self._drive.plan(), now, keys
        part = next(self._parts)
        while not isinstance(part, MadePlan):
            if self._io.monotonic() - now > _DRAW:
                return
            part = next(self._parts)
        self._parts, self._plan = None, part
        self._next_plan = now + max(_DRAW_EVERY, now - self._parts_began)
        self._walls = FloorPlan(self._name, part.walls) if part.walls else None
        self._say_walls()

    def _say_walls(self) -> None:
        self._map.put(MapWalls(map=self._name, walls=self._plan.walls if self._plan is not None else ()))

    def _trouble(self, now: float) -> Trouble:
        if now - self._heard > _SILENCE:
            return NO_SCAN
        return self._drive.trouble if self._drive.trouble is not NO_SCAN else NO_TROUBLE

    def _pose_sample(self, now: float) -> MapPose:
        drive, trouble = self._drive, self._trouble(now)
        (here, tick), odom = self._here(), drive.odom_frame
        return MapPose(
            state="no_map" if drive.tick is None else "lost" if trouble else "localized",
            x=here.x,
            y=here.y,
            yaw=here.yaw,
            covariance=_COVARIANCE,
            odom=PlanarPose(x=odom.x, y=odom.y, yaw=odom.yaw),
            candidates=(),
            explained=drive.mapper.keys[-1].share if drive.mapper.keys else 0.0,
            way=0.0,
            particles=0,
            map=self._name,
            reason=trouble,
            tick=tick,
        )

    def _here(self) -> tuple[Pose, RobotTime | None]:
        """Return where the robot is by the newest turn and odometry since, and of which moment that is."""
        drive, newest = self._drive, self._newest
        if drive.tick is None or newest is None or newest.tick.epoch != drive.tick.epoch:
            return drive.here, drive.tick
        here = Pose(newest.x, newest.y, newest.yaw).placed_in(drive.odom_frame)
        since = newest.tick.robot_ns - drive.tick.robot_ns
        is_motion = 0 < since < _SINCE_NS and math.dist(here[:2], drive.here[:2]) < _FARTHEST
        return (here, newest.tick) if is_motion else (drive.here, drive.tick)

    def _odom_frame(self) -> Transform | None:
        """Return where `odom` is in `map`; None: that is not known."""
        drive = self._drive
        if drive.tick is None:
            return None
        x, y, yaw = drive.odom_frame
        return Transform(parent=MAP_FRAME, child=ODOM_FRAME, x=x, y=y, yaw=yaw, fixed=False, tick=drive.tick)

    def _show(self, now: float) -> None:
        figures = self._plan.figures if self._plan is not None else None
        words = now_text(self._drive, self._trouble(now), figures)
        view = GrowingPlan(
            robot=self._robot,
            elapsed=now - self._began,
            words=words,
            pose=self._pose_sample(now),
            walls=self._walls,
            way=self._drive.way,
            as_json=self._as_json,
        )
        try:
            self._screen.show(view)
        except OSError:  # nobody sees it any more
            discard_stdout()
            self._io.leave()
