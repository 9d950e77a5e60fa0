"""Drives through homes as a laser scanner tells them, with an odometry that errs, and judges that know the truth."""

import math
from array import array
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import LaserScanner
from giraff_maps.room_file import Point
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NO_ECHO, RAYS, LaserScan, packed
from tests.support.scan_worlds import NOTHING, REACH, Floats, Met, Person, World

SCANNER: Final = LaserScanner(x=-0.115, y=0.0, yaw=0.4, own=())
"""The scanner of the robot file."""
_AS_FILED: Final = Pose(0.0, 0.0, 0.0)
_STEP: Final = 0.02  # s
_TRACK: Final = 0.47  # m
_BEGIN_NS: Final = 5_000_000_000  # of robot's time
_FIRST: Final = 0.2  # s from the begin of a drive until the first scan
_AHEAD: Final = 0.3  # m to the point of the way that the robot steers to
_TURNS_ON_SPOT: Final = 0.8  # rad off the way
_SPIN_EACH: Final = 8.0  # m
_SPINS: Final = 0.02, 0.06  # m by which a wheel spins each time
_SPIN_STEP: Final = 0.004  # m a step
_CARRIED: Final = 1.5  # m, and 70 degrees
_CARRIED_TURN: Final = math.radians(70.0)
_MOST: Final = 60_000  # steps
_NOISE: Final = 0.010  # m
_SHAKES: Final = 0.0015  # rad by which a ray is off
_LOST: Final = 0.005  # share of the rays
_SLANTED: Final = 0.17  # cosine of the incidence below which more and more is lost
_JUMP: Final = 0.3  # m between neighbours, of which a ray may tell a mixture
_MIXED: Final = 0.3  # share of those


class Track(NamedTuple):
    """A drive as it was, and as odometry has it: a row each `_STEP` s."""

    true: Floats
    """m, m, rad without jumps of the angle."""
    odom: Floats
    forward_scale: float = 1.0
    """True m for each m of odometry, where no wheel spins."""
    turn_scale: float = 1.0
    """True rad for each rad of odometry, with the slip of turning."""

    @property
    def seconds(self) -> float:
        return (len(self.true) - 1) * _STEP

    def at(self, seconds: Any, rows: Floats) -> Floats:
        """Return x, y and yaw then: `rows` is `true` or `odom`."""
        times = np.arange(len(rows)) * _STEP
        return np.stack([np.interp(seconds, times, column) for column in rows.T])


class ScannedDrive(NamedTuple):
    """Samples of a drive, and the truth."""

    scans: list[LaserScan]
    truth: list[Pose]
    """True pose of `base_link` when ray 0 of each scan was measured."""
    forward_scale: float
    """True m for each m of odometry, where no wheel spins."""
    turn_scale: float
    """True rad for each rad of odometry, with the slip of turning."""
    way: float
    """m."""


class Unit:
    """One scanner LD19 as its data sheet has it: each has a bias of its own, with a slow wave over the distance."""

    def __init__(self, seed: int, mount: LaserScanner = SCANNER, *, bias: float = 0.010, exact: bool = False) -> None:
        """`mount`: where it truly sits; `bias`: m at most, without the wave; `exact`: it does not err at all."""
        self._chance = np.random.default_rng([seed, 5])
        self._mount, self._exact = mount, exact
        self._bias = self._chance.uniform(-bias, bias)
        self._wave = self._chance.uniform(0.3, 0.7) * bias
        self._phase = self._chance.uniform(0.0, math.tau)

    def ranges(self, world: World, poses: Floats, step: float, people: Sequence[Point] = ()) -> bytes:
        """Return what it tells of a turn. `poses`: x, y and yaw of the robot at each ray."""
        mount, (x, y, yaw) = self._mount, poses
        cos, sin = np.cos(yaw), np.sin(yaw)
        origins = np.stack([x + cos * mount.x - sin * mount.y, y + sin * mount.x + cos * mount.y], axis=1)
        bearings = yaw + mount.yaw + step * np.arange(RAYS)
        if not self._exact:
            bearings += self._chance.normal(0.0, _SHAKES, RAYS)
        met = world.met(origins, bearings, people, self._chance)
        told = met.far if self._exact else self._told(met)
        mm = np.where((told > REACH) | (met.far > REACH), NO_ECHO, np.rint(told * 1000.0))
        return packed(array("H", mm.astype(np.uint16).tobytes()))

    def _told(self, met: Met) -> Floats:
        """Return m with the errors; `NOTHING` of a lost ray."""
        far, chances = met.far, self._chance.random((5, RAYS))
        told = far + self._bias + self._wave * np.sin(2.0 * far + self._phase) + self._chance.normal(0.0, _NOISE, RAYS)
        after = np.roll(far, -1)
        mixed = (np.abs(after - far) > _JUMP) & (after < NOTHING) & (chances[0] < _MIXED)
        told = np.where(mixed, far + chances[1] * (after - far), told)
        lost = (chances[2] < _LOST) | (chances[3] < (_SLANTED - met.cosine) / _SLANTED) | (told < 0.02)
        lost |= met.dark & (chances[4] < np.clip((far - 1.0) / 3.0, 0.3, 1.0))
        return np.where(lost, NOTHING, told)


def scanned(
    world: World,
    track: Track,
    unit: Unit,
    scanner: LaserScanner = SCANNER,
    *,
    hz: float = 10.0,
    people: Sequence[Person] = (),
) -> ScannedDrive:
    """Return the samples of a drive. `scanner`: as the robot file has it; `hz`: turns of the motor in a second."""
    step = math.tau / RAYS * (1.0 if scanner.upside_down else -1.0)
    scans, truth = list[LaserScan](), list[Pose]()
    for number in range(int((track.seconds - _FIRST) * hz)):
        begin = _FIRST + number / hz
        poses = track.at(begin + np.arange(RAYS) / (RAYS * hz), track.true)
        robot = Pose(*poses[:, 0].tolist())
        ranges = unit.ranges(world, poses, step, [person(begin, robot) for person in people])
        x, y, yaw = track.at(begin, track.odom).tolist()
        ticks = math.floor(begin / _STEP)
        scans.append(
            LaserScan(
                seq=number,
                sensor="laser",
                ranges=ranges,
                bearing=scanner.yaw,
                step=step,
                duration=1.0 / hz,
                since_tick=begin - ticks * _STEP,
                odom=(x, y, math.remainder(yaw, math.tau)),
                tick=RobotTime(1, _BEGIN_NS + round(ticks * _STEP * 1e9)),
            )
        )
        truth.append(robot._replace(yaw=math.remainder(robot.yaw, math.tau)))
    way = float(np.hypot(*np.diff(track.true[:, :2], axis=0).T).sum())
    return ScannedDrive(scans, truth, track.forward_scale, track.turn_scale, way)


def drive(
    world: World,
    seed: int,
    *,
    speed: float = 0.4,
    hz: float = 10.0,
    bias: float = 0.010,
    route: Sequence[Point] = (),
    people: Sequence[Person] = (),
    carried: bool = False,
    mount_error: Pose = _AS_FILED,
    spin: float | None = None,
) -> ScannedDrive:
    """Drive through a home and return the samples.

    `route`: other goals than the world's. `carried`: somebody carries the robot elsewhere at half of the way.
    `mount_error`: m, m, rad by which the scanner sits elsewhere than the robot file says. `spin`: m by which a wheel
    spins each time, instead of 2 to 6 cm.
    """
    off = mount_error
    mount = LaserScanner(x=SCANNER.x + off.x, y=SCANNER.y + off.y, yaw=SCANNER.yaw + off.yaw, own=())
    track = driven(world, seed, speed=speed, route=route, carried=carried, spin=spin)
    return scanned(world, track, Unit(seed, mount, bias=bias), hz=hz, people=people)


def driven(
    world: World,
    seed: int,
    *,
    speed: float = 0.4,
    route: Sequence[Point] = (),
    carried: bool = False,
    spin: float | None = None,
) -> Track:
    """Return the way of the robot through a home, and odometry's: wheels, track, slip and spinning wheels err."""
    true, motions = list[Pose](), list[tuple[float, float]]()
    for pose, motion in _steered(world, world.way(route or world.goals), speed, carried=carried):
        true.append(pose)
        motions.append(motion)
    return _judged(np.array(true), np.array(motions), seed, spin)


def _steered(
    world: World, way: list[Point], speed: float, *, carried: bool
) -> Iterator[tuple[Pose, tuple[float, float]]]:
    """Yield the pose after each step along the way, and the m and rad of the step."""
    ahead = min(5, len(way) - 1)
    robot = Pose(*way[0], math.atan2(way[ahead][1] - way[0][1], way[ahead][0] - way[0][0]))
    at, forward, turn, half = 0, 0.0, 0.0, len(way) // 2 if carried else _MOST
    yield robot, (0.0, 0.0)
    for _ in range(_MOST):
        while math.dist(way[at], robot[:2]) < _AHEAD:
            at += 1
            if at == len(way):
                return
        if at >= half:
            robot = _elsewhere(world, robot)
            way, at, half = world.way([(robot.x, robot.y), way[at]]) + way[at:], 0, _MOST
        off = math.remainder(math.atan2(way[at][1] - robot.y, way[at][0] - robot.x) - robot.yaw, math.tau)
        wanted = speed * max(0.25, 1.0 - abs(off)), min(1.2, max(-1.2, 1.5 * off))
        if abs(off) > _TURNS_ON_SPOT:
            wanted = 0.0, math.copysign(0.9, off)
        forward += min(0.02, max(-0.02, wanted[0] - forward))
        turn += min(0.08, max(-0.08, wanted[1] - turn))
        robot = robot.moved(forward * _STEP, turn * _STEP)
        yield robot, (forward * _STEP, turn * _STEP)


def _elsewhere(world: World, robot: Pose) -> Pose:
    """Return where somebody puts the robot, in the same room."""
    for number in range(72):
        angle = math.radians(5.0 * 31 * number)
        places = [(robot.x + far * math.cos(angle), robot.y + far * math.sin(angle)) for far in (0.5, 1.0, _CARRIED)]
        if all(world.is_clear(place) for place in places):
            return Pose(*places[-1], robot.yaw + _CARRIED_TURN)
    raise AssertionError(f"there is no free place {_CARRIED} m from {robot}: choose another route")


def _judged(true: Floats, motions: Floats, seed: int, spin: float | None) -> Track:
    """Return a drive as odometry has it."""
    chance, steps = np.random.default_rng([seed, 7]), len(motions)
    wheels = 1.0 + chance.choice([-0.02, 0.02]) + chance.normal(0.0, 0.004, 2)
    track = _TRACK * (1.0 + chance.choice([-0.03, 0.03]))
    forward, turn = motions.T
    ways = np.stack([forward - turn * _TRACK / 2.0, forward + turn * _TRACK / 2.0], axis=1) * wheels
    ways *= 1.0 + np.abs(turn / _STEP)[:, None] * chance.normal(0.02, 0.01, (steps, 2))
    told = ways @ (0.5, 0.5), ways @ (-1.0, 1.0) / track
    scales = [float(once @ seen / (seen @ seen)) for once, seen in zip((forward, turn), told, strict=True)]
    ways[:, chance.integers(2)] += _spins(forward, chance, spin)
    told = ways @ (0.5, 0.5), ways @ (-1.0, 1.0) / track
    yaw = true[0, 2] + np.cumsum(told[1])
    middle = yaw - told[1] / 2.0
    x = true[0, 0] + np.cumsum(told[0] * np.cos(middle))
    y = true[0, 1] + np.cumsum(told[0] * np.sin(middle))
    return Track(true, np.stack([x, y, yaw], axis=1), *scales)


def _spins(forward: Floats, chance: np.random.Generator, spin: float | None) -> Floats:
    """Return m by which a wheel spins in each step: about each 8 m once."""
    extra = np.zeros(len(forward))
    for begin in np.flatnonzero(chance.random(len(forward)) < np.abs(forward) / _SPIN_EACH):
        steps = round((chance.uniform(*_SPINS) if spin is None else spin) / _SPIN_STEP)
        extra[begin : begin + steps] = _SPIN_STEP
    return extra


class PoseError(NamedTuple):
    """Errors of estimated poses, m, when they lie on the true ones as well as they can."""

    mean: float
    worst: float
    alignment: Pose
    """Pose of the estimate's frame in the world."""


def pose_error(truth: Sequence[Pose], estimated: Sequence[Any]) -> PoseError:
    """Judge poses by x and y.

    W. Kabsch, A solution for the best rotation to relate two sets of vectors, Acta Crystallographica A 32 (1976).
    """
    true, found = (np.array([pose[:2] for pose in poses]) for poses in (truth, estimated))
    a, b = true - true.mean(axis=0), found - found.mean(axis=0)
    yaw = math.atan2(float((b[:, 0] * a[:, 1] - b[:, 1] * a[:, 0]).sum()), float((a * b).sum()))
    x, y = (true.mean(axis=0) - aligned(found.mean(axis=0), Pose(0.0, 0.0, yaw))).tolist()
    alignment = Pose(x, y, yaw)
    off = np.hypot(*(aligned(found, alignment) - true).T)
    return PoseError(float(off.mean()), float(off.max()), alignment)


def aligned(points: Floats, alignment: Pose) -> Floats:
    """Return points in the world."""
    cos, sin = math.cos(alignment.yaw), math.sin(alignment.yaw)
    turned: Floats = points @ np.array([[cos, sin], [-sin, cos]]) + alignment[:2]
    return turned


def wall_error(world: World, points: Floats, alignment: Pose) -> Floats:
    """Return m from each point, in the estimate's frame, to the nearest true wall."""
    return world.distances(aligned(points, alignment))
