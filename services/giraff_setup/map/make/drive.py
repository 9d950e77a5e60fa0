"""A drive so far: the turns of one scanner, put together. No I/O, no clock."""

from collections.abc import Iterator
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_maps.floor_plan import MapError
from giraff_maps.scan.mapper import Mapper
from giraff_maps.scan.plan import MadePlan, make_plan
from giraff_maps.scan.turns import Turns
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import LaserScan
from giraff_schemas.trouble import NO_TROUBLE, Trouble

NO_SCAN: Final = Trouble(
    "no scan is heard", "check that giraff_scan runs, that the scanner turns, and the network to the robot"
)
_ORIGIN: Final = Pose(0.0, 0.0, 0.0)
_NO_ODOMETRY: Final = Trouble("the scans come without odometry", "check that giraff_odometry runs on the robot")


class Drive:
    """Give it each scan, in order."""

    def __init__(self, robot: RobotConfig) -> None:
        """Raise MapError where this robot has no laser scanner."""
        self.robot = robot
        self._scanners = robot.of(LaserScanner)
        if not self._scanners:
            raise MapError(
                f"{robot.name} has no laser scanner in its robot file; write [robot.sensors.laser] with "
                'type = "ld19": docs/scan.md shows how'
            )
        self.mapper = Mapper()
        self.scanner = ""
        """Name of the one that the plan is made by: the first one that tells anything. Empty: none has."""
        self.others: set[str] = set()
        """Other scanners that were heard."""
        self.trouble = NO_SCAN
        """Cause, where the newest scan tells no place."""
        self.tick: RobotTime | None = None
        """Moment when the robot was `here`. None: no turn has told a place yet."""
        self._turns: Turns | None = None
        self._odom = _ORIGIN
        """Pose of the robot in `odom` where the mapper has it."""
        self._start = _ORIGIN
        """Frame of the mapper in the newest plan."""

    def add(self, scan: LaserScan) -> None:
        """Take a scan."""
        known = self._scanners.get(scan.sensor)
        if known is None:
            if not self.scanner:
                self.trouble = Trouble(
                    f"a scanner {scan.sensor} is heard, and the robot file has none of this name",
                    "give it this name, or set name of [scan]",
                )
            return
        if not self.scanner and not scan.trouble:
            self.scanner, self._turns, self.trouble = scan.sensor, Turns(known), NO_TROUBLE
        if scan.sensor != self.scanner or self._turns is None:
            self.others.add(scan.sensor)
            self.trouble = self.trouble if self.scanner else scan.trouble
            return
        turn = self._turns.add(scan)
        if turn is not None:
            self.mapper.add(turn)
            self._odom, self.tick = turn.odom, scan.tick
            self.trouble = self.mapper.trouble
        elif scan.trouble or scan.odom is None:
            self.trouble = scan.trouble or _NO_ODOMETRY

    @property
    def way(self) -> float:
        """m that the robot was driven."""
        return self.mapper.keys[-1].way if self.mapper.keys else 0.0

    @property
    def here(self) -> Pose:
        """`base_link` in the newest plan."""
        return (self.mapper.here or _ORIGIN).placed_in(self._start)

    @property
    def odom_frame(self) -> Pose:
        """Place of the frame `odom` in the newest plan."""
        return _ORIGIN.seen_from(self._odom).placed_in(self.here)

    def plan(self, start: Pose | None = None) -> Iterator[MadePlan | float]:
        """Make a plan of what there is, as `make_plan`. There is a key turn at least."""
        scanner = self._scanners[self.scanner]
        for part in make_plan(self.mapper, Pose(scanner.x, scanner.y, 0.0), start):
            if isinstance(part, MadePlan):
                self._start = part.start
            yield part
