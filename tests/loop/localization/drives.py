"""Drives through a floor, with the truth beside what a robot says of itself: for whoever looks for it on a map.

There are no boards and no services but odometry's policy, so that a drive of 40 m takes seconds. The driver is a
person, who sees what stands there; the robot is one that nobody has calibrated.
"""

import hashlib
import heapq
import math
import os
import pickle
import random
import zlib
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

from giraff_core.live import Live
from giraff_odometry import policy as odometry_module
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_ranger.policy import reading
from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.messages import Odometry, Range, RobotTime, Wheels
from giraff_schemas.wire import RangeFault, RangeFrame, RangeState
from giraff_sim import truth as truth_module
from giraff_sim.board import BUILD
from giraff_sim.bodies.registry import world_of
from giraff_sim.bodies.wheels import plant as plant_module
from giraff_sim.config import SimConfig
from giraff_sim.truth import draw_truth
from giraff_sim.world import room as room_module
from giraff_sim.world import sonar as sonar_module
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Pose
from giraff_sim.world.sonar import SonarFault
from tests.loop.localization import floors
from tests.loop.localization.floors import FILES, Cell, Differences, Floor, Rectangle, floor, start_at
from tests.support.robots import DRIVE, ROBOT, ULTRASONIC
from tests.support.wheels import wheels_of

_KEPT: Final = BUILD / "localization"
STEP_MS: Final = 5
CONTROL_MS: Final = 10
WHEELS_MS: Final = 20
PING_MS: Final = 60
"""One sensor after the other: 5.6 Hz each."""
_AIR_MS: Final = 30  # from a ping to its reading
_TICK_LATE_MS: Final = 15  # at most, until the ranger board knows the newest tick
_LONGEST_US: Final = 23_300.0  # of an echo that the ranger board takes for one
_EPOCH: Final = 1
_BEGAN_MS: Final = 1000

_SPEED: Final = 0.35  # m/s
_TURN: Final = 0.8  # rad/s
_AHEAD: Final = 4  # cells down the field
_ARRIVED: Final = 0.35  # m
_PERSON: Final = "person"
_PERSON_RADIUS: Final = 0.2  # m


class Variation(NamedTuple):
    """What is special about a drive."""

    world: str
    metres: float = 40.0
    differences: Differences = Differences(sloppy=0.03)
    wild_share: float = 0.05
    person: bool = False
    """Somebody stands 0.7 to 1.3 m before the robot about half of the time, and steps back as it comes."""
    deaf: bool = False
    """One sensor hears nothing."""
    kidnapped_after: float = math.inf
    """m, and by the seed up to 6 m more: then it is put down elsewhere, far off."""
    parts: tuple[Rectangle, ...] = ()
    """It stays in one of these, by the seed."""


class Moment(NamedTuple):
    """What the robot says, and where it truly is as it says so."""

    message: Odometry | Range
    truth: Pose
    path: float
    """m truly driven."""


class Drive(NamedTuple):
    """One drive."""

    variation: Variation
    seed: int
    moments: list[Moment]
    kidnapped_at: float | None
    """m of the path."""
    contacts: int


def drive(variation: Variation, seed: int) -> Drive:
    """The drive of this seed: made once, then kept below build/ until what it is made by changes."""
    which = hashlib.sha256(f"{variation} {seed}".encode()).hexdigest()[:16]
    path = _KEPT / f"{which}-{_sources()[:16]}.pickle"
    if path.exists():
        kept: Drive = pickle.loads(zlib.decompress(path.read_bytes()))  # noqa: S301 - written below
        return kept
    made = _Run(variation, seed).drive()
    _KEPT.mkdir(parents=True, exist_ok=True)
    for outdated in _KEPT.glob(f"{which}-*"):
        outdated.unlink(missing_ok=True)
    partly = path.with_suffix(f".{os.getpid()}")
    partly.write_bytes(zlib.compress(pickle.dumps(made), 1))
    partly.replace(path)
    return made


@cache
def _sources() -> str:
    """Of all that a drive is made by, but for what the world and odometry are made of themselves."""
    modules = [floors, room_module, plant_module, sonar_module, truth_module, odometry_module]
    paths = [Path(__file__), *(Path(str(module.__file__)) for module in modules), *FILES.values()]
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths if path.exists())).hexdigest()


class _Run:
    """A robot without boards, and its driver."""

    def __init__(self, variation: Variation, seed: int) -> None:
        self._variation, self._seed = variation, seed
        self._random = random.Random(f"{seed}/drive")
        self._floor = floor(variation.world, variation.differences, seed)
        part = variation.parts[seed % len(variation.parts)] if variation.parts else None
        self._cells = self._floor.within(part)
        start_at(self._floor, self._random.choice(self._cells), self._random.uniform(-math.pi, math.pi))
        sim = SimConfig()
        truth = draw_truth("uncalibrated", sim.truth, seed)
        self._world = world_of(self._floor.room, ROBOT, DRIVE, sim, StillHand(), seed, truth=truth)
        self._plant = wheels_of(self._world).plant
        for number, sonar in self._world.sonars.items():
            sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, variation.wild_share
            if variation.deaf and number == seed % len(self._world.sonars):
                sonar.fault = SonarFault.DEAF
        self._driver = Driver(self._floor, self._cells, self._random)
        self._odometry = OdometryPolicy(Live(OdometryConfig()), ROBOT)
        self._person = _Person(self._random) if variation.person else None
        self._speeds = [0.0, 0.0]  # m/s wished of each wheel, as far as it has been ramped up
        self._integrals = [0.0, 0.0]
        self._duties = [0.0, 0.0]
        self._air: list[tuple[int, Range]] = []
        self._moments: list[Moment] = []
        self._kidnapped_at: float | None = None

    def drive(self) -> Drive:
        names = {mount.index: name for name, mount in ULTRASONIC.items()}
        kidnap = self._variation.kidnapped_after + self._seed % 7
        now, pings = 0, 0
        while self._plant.path_length < self._variation.metres:
            if self._plant.path_length >= kidnap:
                self._kidnap()
                kidnap = math.inf
            self._control()
            for _ in range(CONTROL_MS // STEP_MS):
                self._plant.step(STEP_MS / 1000.0, *self._duties)
            now += CONTROL_MS
            if now % WHEELS_MS == 0:
                self._tell(self._wheels(now))
            while self._air and self._air[0][0] <= now:
                self._keep(self._air.pop(0)[1])
            if now % PING_MS == 0:
                if self._person:
                    self._person.step(self._floor, self._plant.pose, self._plant.path_length, now / 1000.0)
                number = pings % len(names)
                self._air.append((now + _AIR_MS, self._reading(names[number], number, now)))
                pings += 1
        return Drive(self._variation, self._seed, self._moments, self._kidnapped_at, self._plant.contacts)

    def _control(self) -> None:
        v, w = self._driver.wish(self._plant.pose)
        half = w * ROBOT.track_width / 2.0
        for side, (wheel, wish) in enumerate(((self._plant.left, v - half), (self._plant.right, v + half))):
            most = 0.6 * CONTROL_MS / 1000.0
            self._speeds[side] += min(most, max(-most, wish - self._speeds[side]))
            error = self._speeds[side] - wheel.speed
            self._integrals[side] = min(0.3, max(-0.3, self._integrals[side] + 3.0 * error * CONTROL_MS / 1000.0))
            level = self._speeds[side] + 2.0 * error + self._integrals[side]
            self._duties[side] = min(255.0, max(-255.0, level * DRIVE.max_level / ROBOT.max_wheel_speed))

    def _kidnap(self) -> None:
        away = self._driver.field(self._floor.cell(*self._plant.pose[:2]))
        far = sorted((cell for cell in self._cells if cell in away), key=away.__getitem__)
        self._kidnapped_at = self._plant.path_length
        there = self._random.choice(far[len(far) // 2 :])
        self._plant.place(Pose(*self._floor.middle(there), self._random.uniform(-math.pi, math.pi)))
        self._speeds = [0.0, 0.0]
        self._integrals = [0.0, 0.0]
        self._driver.anew()

    def _wheels(self, now: int) -> Wheels:
        left, right = self._plant.left, self._plant.right
        return Wheels(
            left_ticks=math.floor(left.states / BASE_BOARD.states_per_tick),
            right_ticks=math.floor(right.states / BASE_BOARD.states_per_tick),
            left_velocity=left.speed,
            right_velocity=right.speed,
            left_pwm_counts=round(self._duties[0]),
            right_pwm_counts=round(self._duties[1]),
            board_us=now * 1000,
            boot_id=1,
            tick=RobotTime(epoch=_EPOCH, robot_ns=(_BEGAN_MS + now) * 1_000_000),
            instance="base",
        )

    def _tell(self, wheels: Wheels) -> None:
        odometry = self._odometry.on_wheels(wheels)
        if odometry is not None:
            self._keep(odometry)

    def _keep(self, message: Odometry | Range) -> None:
        self._moments.append(Moment(message, self._plant.pose, self._plant.path_length))

    def _reading(self, name: str, number: int, now: int) -> Range:
        echo_us = self._world.echo_us(number)
        state = RangeState.ECHO if echo_us <= _LONGEST_US else RangeState.CLEAR
        held = (now - self._random.randint(0, _TICK_LATE_MS)) // WHEELS_MS * WHEELS_MS
        frame = RangeFrame(
            seq=0,
            board_us=now * 1000,
            boot_id=1,
            tick_epoch=_EPOCH,
            tick_robot_ns=(_BEGAN_MS + held) * 1_000_000,
            sensor=number,
            state=state,
            fault=RangeFault.NONE,
            echo_us=round(echo_us),
            line_errors=0,
        )
        return reading(name, frame, 1.0)


class Driver:
    """Goes from place to place by the middle of the ways, and sees what stands there; it turns on the spot at times."""

    def __init__(self, here: Floor, cells: list[Cell], choose: random.Random) -> None:
        self._floor, self._cells, self._random = here, cells, choose
        self._goal: Cell | None = None
        self._field: dict[Cell, float] = {}
        self._spin, self._last_yaw = 0.0, 0.0  # rad left to turn on the spot
        self._wished = (0.0, 0.0)
        self._count = 0

    def anew(self) -> None:
        """Look for another goal."""
        self._goal, self._spin = None, 0.0

    def wish(self, pose: Pose) -> tuple[float, float]:
        """m/s and rad/s; thought over five times less often than asked for."""
        if self._count % 5 == 0:
            self._wished = self._think(pose)
        self._count += 1
        return self._wished

    def field(self, goal: Cell) -> dict[Cell, float]:
        """What it costs to get to a goal from each cell: less by the middle of the ways."""
        cost, queue = {}, [(0.0, goal)]
        best = {goal: 0.0}
        clearance, free = self._floor.clearance, self._floor.free
        while queue:
            price, cell = heapq.heappop(queue)
            if cell in cost:
                continue
            cost[cell] = price
            for di, dj, far in _STEPS:
                near = cell[0] + di, cell[1] + dj
                if near in free and near not in cost:
                    new = price + far * (1.0 + max(0.0, 0.7 - clearance[near]) * 6.0)
                    if new < best.get(near, math.inf):
                        best[near] = new
                        heapq.heappush(queue, (new, near))
        return cost

    def _think(self, pose: Pose) -> tuple[float, float]:
        if self._goal is None or math.dist(self._floor.middle(self._goal), pose[:2]) < _ARRIVED:
            if self._goal is not None and self._random.random() < 0.4:
                self._spin = self._random.choice((-1.0, 1.0)) * self._random.uniform(1.5, 6.0)
                self._last_yaw = pose.yaw
            self._goal = self._random.choice(self._cells)
            self._field = self.field(self._goal)
        if self._spin:
            turned = math.remainder(pose.yaw - self._last_yaw, math.tau)
            self._last_yaw = pose.yaw
            left = self._spin - turned
            self._spin = left if left * self._spin > 0.0 else 0.0
            return 0.0, math.copysign(_TURN, left)
        x, y = self._ahead(self._floor.cell(pose.x, pose.y))
        error = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, math.tau)
        v = _SPEED * math.cos(error) ** 2 if abs(error) < 0.7 else 0.0
        return v, max(-_TURN, min(_TURN, 2.0 * error))

    def _ahead(self, cell: Cell) -> tuple[float, float]:
        if cell not in self._field:  # a little beside what is free
            cell = min(self._field, key=lambda other: math.dist(other, cell))
        for _ in range(_AHEAD):
            near = ((cell[0] + di, cell[1] + dj) for di, dj, _ in _STEPS)
            cell = min((cell, *near), key=lambda other: self._field.get(other, math.inf))
        return self._floor.middle(cell)


_STEPS: Final = tuple((di, dj, math.hypot(di, dj)) for di in (-1, 0, 1) for dj in (-1, 0, 1) if di or dj)


class _Person:
    """Somebody who talks with the robot's operator, and walks backwards before it."""

    def __init__(self, choose: random.Random) -> None:
        self._random = choose
        self._stands: tuple[float, float] | None = None
        self._is_there = False
        self._until = 0.0
        self._next = choose.uniform(2.0, 4.0)

    def step(self, here: Floor, robot: Pose, path: float, seconds: float) -> None:
        if self._stands is None and path > self._next:
            self._stands = self._random.uniform(0.7, 1.3), self._random.uniform(-0.15, 0.15)
            self._until = seconds + self._random.uniform(6.0, 15.0)
            self._next = path + self._random.uniform(4.0, 8.0)
        if self._stands is not None and seconds > self._until:
            self._stands = None
        if self._is_there:
            here.room.remove(_PERSON)
        self._is_there = False
        if self._stands is not None:
            ahead, aside = self._stands
            x = robot.x + ahead * math.cos(robot.yaw) - aside * math.sin(robot.yaw)
            y = robot.y + ahead * math.sin(robot.yaw) + aside * math.cos(robot.yaw)
            if here.room.clearance(x, y) > _PERSON_RADIUS:
                here.room.add_post(_PERSON, x, y, _PERSON_RADIUS)
                self._is_there = True
