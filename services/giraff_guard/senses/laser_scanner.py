"""Laser scanners as a sense of the guard: points all round, of the last turns."""

import math
from collections.abc import Sequence
from typing import Final

import msgspec

from giraff_core.freshness import age
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_guard.config import GuardConfig
from giraff_guard.geometry import Point
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.source import Beam, Points, Sight, Source
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NO_ECHO, OWN, RAYS, SECTOR_RAYS, SECTORS, LaserScan
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TURNS: Final = 2
"""Turns that must have come since a silence, so that one wild turn opens nothing."""
_KEPT_S: Final = 0.35
"""s for which a point counts: three turns, since a thin leg is not met by each."""
_CELL: Final = 0.04
"""m. Side of a cell of the floor, in which the point that is nearest to the scanner counts."""
_SPREAD: Final = 0.02
"""m around a point: twice the noise of a range."""
_SLACK: Final = 0.3
"""m that the robot may come nearer while a turn counts."""
_MATTERS: Final = math.radians(60.0)
"""rad at the robot's middle, to either side of its way. Farther aside its rim can only graze something."""

_FIRST: Final = Trouble("has told one turn, and needs two", "wait")
_ANOTHER: Final = Trouble("giraff_scan goes by another robot file", "restart it, at rest")
_LEANS: Final = Trouble("this robot leans, so that it looks at the floor or over what stands there")
_UNMEASURED: Final = Trouble("nobody has looked for what the robot hides from it", "run giraff calibrate scan")


Arc = tuple[float, float]
"""rad in `base_link`, counter-clockwise from the first to the second."""


class _Scanner(msgspec.Struct):
    """The last turns of one scanner."""

    turns: int = 0
    """Since it was silent."""
    tick: RobotTime | None = None
    trouble: Trouble = NO_TROUBLE
    cells: dict[tuple[int, int], tuple[int, int, float, float]] = msgspec.field(default_factory=dict)
    """By place in cells: robot_ns, mm from the scanner, x, y, in the frame of `RecentTravel.place`."""
    points: list[Point] = msgspec.field(default_factory=list)
    place: Pose = Pose(0.0, 0.0, 0.0)
    """Place of the robot at the end of the newest turn."""
    blind: list[DriveDirection] = msgspec.field(default_factory=list)
    """Ways of which a part was not seen in the newest turn."""


class LaserScannerSource(Source):
    """All laser scanners of one robot. A way of which one does not see all is crept."""

    sense, sees_ahead = LaserScanner, True

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        super().__init__(live, robot)
        self._mounts = robot.of(LaserScanner)
        self._robot = robot
        self._limits = Limits(live, robot)
        self._matters: dict[str, dict[DriveDirection, Arc]] = {
            name: {way: _matters(mount, sign * robot.footprint_radius) for way, sign in SIGN.items()}
            for name, mount in self._mounts.items()
        }
        self._scanners = {name: _Scanner() for name in self._mounts}
        self._rays: tuple[float, float, list[Point]] = (math.nan, math.nan, [])

    def covers(self, way: DriveDirection) -> Sequence[str]:
        """Return all: each looks all round."""
        del way
        return list(self._mounts)

    def on_sample(self, sample: LaserScan, motion: RecentTravel, now: RobotTime) -> Sequence[Beam]:
        """Take a turn, each ray from where the robot then was."""
        name, tick = sample.sensor, sample.tick or now
        scanner = self._scanners[name]
        if scanner.tick is None or age(scanner.tick, tick) > self.live.config.range_budget:
            scanner.turns = 0
            scanner.cells.clear()
        mount = self._mounts[name]
        is_same = (sample.bearing, sample.step > 0.0) == (mount.yaw, mount.upside_down)
        scanner.tick, scanner.trouble = tick, sample.trouble or (NO_TROUBLE if is_same else _ANOTHER.of(name))
        if scanner.trouble:
            scanner.turns = 0
            return ()
        scanner.turns += 1
        begun_ns = tick.robot_ns + round(sample.since_tick * 1e9)
        self._see(scanner, mount, sample, begun_ns, motion)
        ended_ns = begun_ns + round(sample.duration * 1e9)
        scanner.place = motion.place_at(ended_ns)
        blind = [_middle(sample, sector) for sector in sample.blind]
        arcs = self._matters[name]
        scanner.blind = [way for way in arcs if any(_within(bearing, arcs[way]) for bearing in blind)]
        self._forget(scanner, mount, sample, ended_ns)
        scanner.points = [(x, y) for _, _, x, y in scanner.cells.values()]
        return ()

    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return the points of the last turns. After a silence the scanner is blind until there are two."""
        del motion, now
        scanner, mount = self._scanners[sensor], self._mounts[sensor]
        if scanner.trouble:
            return Sight(sensor, blind=scanner.trouble)
        if scanner.turns < _TURNS:
            return Sight(sensor, blind=_FIRST.of(sensor))
        reach = min(mount.reach - math.hypot(mount.x, mount.y), self._far)
        return Sight(
            sensor,
            points=Points(scanner.points, _SPREAD, reach, scanner.place),
            doubt=self._doubt(sensor, way),
            doubtful_speed=self.live.config.creep_linear,
        )

    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Return what its service says is wrong with it. A part of a way that it does not see is the way's trouble."""
        del motion, now
        return self._scanners[sensor].trouble

    def forget(self) -> None:
        """Begin anew."""
        self._scanners = {name: _Scanner() for name in self._mounts}

    def lose_place(self) -> None:
        """Take note that points of before are no longer where they seem to be."""
        self.forget()

    @property
    def _far(self) -> float:
        """m from the robot's middle beyond which nothing limits its speed."""
        config = self.live.config
        stops_within = self._limits.stops_within(self._robot.max_wheel_speed)
        runs_on = self._robot.max_wheel_speed * config.range_budget
        return self._robot.footprint_radius + config.margin + config.release + stops_within + runs_on + _SLACK

    def _doubt(self, sensor: str, way: DriveDirection) -> Trouble:
        """Return why the robot creeps this way, however free it looks."""
        mount = self._mounts[sensor]
        if self.live.config.run_on > 0.0:
            return _LEANS.of(sensor)
        if mount.own is None:
            return _UNMEASURED.of(sensor)
        arc = self._matters[sensor][way]
        if any(_overlap((mount.yaw + begin, mount.yaw + end), arc) for begin, end in mount.own):
            return Trouble(f"{sensor}: the robot itself hides a part of the way {way}")
        if way in self._scanners[sensor].blind:
            what = f"{sensor} sees nothing in a part of the way {way}"
            return Trouble(what, "see that nothing covers it; black, glass and wide open space look like that, too")
        return NO_TROUBLE

    def _see(
        self, scanner: _Scanner, mount: LaserScanner, sample: LaserScan, begun_ns: int, motion: RecentTravel
    ) -> None:
        """Put what each ray has met where it is."""
        unit, cells = self._unit(sample), scanner.cells
        far, inside = round(1000.0 * (self._far + math.hypot(mount.x, mount.y))), self._robot.footprint_radius
        mms, ray_ns = sample.rays(), sample.duration * 1e9 / RAYS
        for rays in SECTOR_RAYS:
            sector_ns = begun_ns + round((rays.start + rays.stop) / 2.0 * ray_ns)
            place = motion.place_at(sector_ns)
            cos, sin = math.cos(place.yaw), math.sin(place.yaw)
            x, y = place.x + cos * mount.x - sin * mount.y, place.y + sin * mount.x + cos * mount.y
            for ray in rays:
                mm = mms[ray]
                if not NO_ECHO < mm < OWN or mm > far:
                    continue
                along, across = unit[ray]
                seen_x = x + mm * (cos * along - sin * across)
                seen_y = y + mm * (sin * along + cos * across)
                if mount.own is None and math.hypot(seen_x - place.x, seen_y - place.y) < inside:
                    continue  # the robot's own parts, of which nobody knows yet
                cell = round(seen_x / _CELL), round(seen_y / _CELL)
                known = cells.get(cell)
                if known is None or known[0] < begun_ns or mm < known[1]:
                    cells[cell] = sector_ns, mm, seen_x, seen_y

    def _unit(self, sample: LaserScan) -> list[Point]:
        """Return 1 mm along each ray, in m of `base_link`."""
        bearing, step, unit = self._rays
        if (bearing, step) != (sample.bearing, sample.step):
            bearings = [sample.bearing + ray * sample.step for ray in range(RAYS)]
            unit = [(math.cos(each) / 1000.0, math.sin(each) / 1000.0) for each in bearings]
            self._rays = sample.bearing, sample.step, unit
        return unit

    def _forget(self, scanner: _Scanner, mount: LaserScanner, sample: LaserScan, now_ns: int) -> None:
        """Drop what no ray has met for three turns; where a sector is blind, what none has met for `silent_time`."""
        config, blind, place = self.live.config, set(sample.blind), scanner.place
        oldest_ns, oldest_blind_ns = now_ns - round(_KEPT_S * 1e9), now_ns - round(config.silent_time * 1e9)
        for cell, (seen_ns, _, x, y) in [*scanner.cells.items()]:
            if seen_ns >= oldest_ns:
                continue
            ahead, left = place.sees(x, y)
            bearing = math.atan2(left - mount.y, ahead - mount.x)
            ray = round((bearing - sample.bearing) / sample.step) % RAYS
            if ray * SECTORS // RAYS not in blind or seen_ns < oldest_blind_ns:
                del scanner.cells[cell]


def _matters(mount: LaserScanner, ahead: float) -> Arc:
    """Return where a scanner looks at what is in the way. `ahead`: m to the robot's rim, negative: backward."""
    right, left = (
        math.atan2(side * math.sin(_MATTERS) * ahead - mount.y, math.cos(_MATTERS) * ahead - mount.x)
        for side in (-1.0, 1.0)
    )
    return right, right + (left - right) % math.tau


def _middle(sample: LaserScan, sector: int) -> float:
    return sample.bearing + sample.step * (sector + 0.5) * RAYS / SECTORS


def _within(bearing: float, arc: Arc) -> bool:
    """Return whether a sector of 10 degrees about this bearing reaches into an arc."""
    half = math.pi / SECTORS
    return _overlap((bearing - half, bearing + half), arc)


def _overlap(one: Arc, other: Arc) -> bool:
    """Return whether two arcs have a part in common."""
    return (other[0] - one[0]) % math.tau <= one[1] - one[0] or (one[0] - other[0]) % math.tau <= other[1] - other[0]
