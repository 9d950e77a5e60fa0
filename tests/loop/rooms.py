"""Random cluttered rooms, and a driver who sees nothing of them but the guard's verdicts."""

import heapq
import math
import random
from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from typing import Any, Final, NamedTuple

import msgspec

from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.world.bno055 import Vector
from giraff_sim.world.hand import LEVEL
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import SETTINGS, arm, closed_loop, drawn, spare_time
from tests.loop.reaction import tilted
from tests.support.robots import ROBOT, ULTRASONIC

SIZE: Final = 5.0  # m, of each side of a room
START: Final = (0.8, 0.8)
EXIT: Final = (4.2, 4.2)
AT_EXIT: Final = 0.25  # m
PATIENCE: Final = 300.0  # s
WILD_SHARE: Final = 0.05
_CELL: Final = 0.1  # m
_WRIST_S: Final = 0.15  # s, time constant: a hand that jerks is taken for a joystick that is shaken
_STUCK_S: Final = 3.0  # s without 5 cm of way, though forward is allowed
_SURE: Final = math.cos(math.radians(25.0))  # of the incidence
_REACTION_US: Final = 40_000
NEARLY: Final = 0.06  # m between an echo and the surface that gave it, with what the robot moved meanwhile

Cell = tuple[int, int]


def cluttered(seed: int) -> Room:
    """Boxes and posts wherever they fall, but not on start and exit."""
    choose = random.Random(f"{seed}/room")
    room = Room(f"room {seed}", Pose(*START, choose.uniform(-math.pi, math.pi)))
    room.add_wall("walls", [(0.0, 0.0), (SIZE, 0.0), (SIZE, SIZE), (0.0, SIZE)], closed=True)
    for number in range(choose.randint(3, 8)):
        x, y, turned = choose.uniform(0.3, SIZE - 0.3), choose.uniform(0.3, SIZE - 0.3), choose.uniform(0.0, math.pi)
        if choose.random() < 0.4:
            radius = choose.uniform(0.03, 0.2)
            if min(math.dist((x, y), START), math.dist((x, y), EXIT)) > 0.8 + radius:
                room.add_post(f"post {number}", x, y, radius)
            continue
        half_x, half_y = choose.uniform(0.2, 0.6), choose.uniform(0.2, 0.6)
        cos, sin = math.cos(turned), math.sin(turned)
        corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
        if min(math.dist((x, y), START), math.dist((x, y), EXIT)) > 0.8 + math.hypot(half_x, half_y):
            points = [(x + cos * u - sin * v, y + sin * u + cos * v) for u, v in corners]
            room.add_wall(f"box {number}", points, closed=True)
    return room


def shortest(start: Cell, goal: Cell, cost: Callable[[Cell], float]) -> list[Cell]:
    """The cells of the cheapest way, start and goal included; empty when there is none. `cost`: of entering one."""
    best = {start: 0.0}
    before: dict[Cell, Cell] = {}
    queue = [(math.dist(start, goal), start)]
    while queue:
        _, cell = heapq.heappop(queue)
        if cell == goal:
            way = [goal]
            while way[-1] != start:
                way.append(before[way[-1]])
            return way[::-1]
        for step in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            entered = (cell[0] + step[0], cell[1] + step[1])
            price = best[cell] + math.hypot(*step) * cost(entered)
            if price < best.get(entered, math.inf):
                best[entered], before[entered] = price, cell
                heapq.heappush(queue, (price + math.dist(entered, goal), entered))
    return []


def cell_of(x: float, y: float) -> Cell:
    return round(x / _CELL), round(y / _CELL)


def has_way(room: Room) -> bool:
    """Whether a disc of the footprint's radius plus the margin can get to the exit."""
    radius = ROBOT.footprint_radius + SETTINGS.guard.margin

    def cost(cell: Cell) -> float:
        return 1.0 if room.clearance(cell[0] * _CELL, cell[1] * _CELL) >= radius else math.inf

    return bool(shortest(cell_of(*START), cell_of(*EXIT), cost))


class Wrist:
    """Holds the joystick as it is meant to be, no faster than a hand moves."""

    def __init__(self) -> None:
        self._held: Vector = LEVEL
        self._time = 0.0

    def towards(self, meant: Vector, seconds: float) -> Vector:
        """How it is held at `seconds`, having been meant so since the last time."""
        passed, self._time = seconds - self._time, seconds
        share = 1.0 - math.exp(-passed / _WRIST_S)
        x, y, z = (held + (to - held) * share for held, to in zip(self._held, meant, strict=True))
        self._held = (x, y, z)
        return self._held


class Explorer:
    """Knows where it is and where the exit is; of what stands between, only what the verdicts say.

    It goes straight for the exit. Where forward is blocked, or it does not get on, it notes that something is there,
    backs up, and takes the shortest way that keeps off all it has noted.
    """

    trembles = True

    def __init__(self, loop: ClosedLoop) -> None:
        self._loop = loop
        self._noted: list[tuple[float, float]] = []
        self._way: list[tuple[float, float]] = []
        self._blocked_s = 0.0
        self._backed_from: tuple[float, float] | None = None
        self._until = 0.0
        self._got_on = (0.0, Pose(math.inf, math.inf, 0.0))
        self._meant: Vector = LEVEL
        self._wrist = Wrist()
        self._next = 0.0

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        if seconds >= self._next:
            self._next = seconds + 0.04
            wish = self._wish(seconds, robot, self._loop.newest["guard"])
            self._meant = tilted(*wish).acceleration(seconds, robot)
        return self._wrist.towards(self._meant, seconds)

    def _wish(self, seconds: float, robot: Pose, state: Any) -> tuple[float, float]:
        if self._backed_from is not None:
            if math.dist(self._backed_from, robot[:2]) < 0.25 and seconds < self._until:
                return -0.25, 0.0
            self._backed_from = None
            self._way = []
        if not self._way:
            self._way = self._planned(robot)
        while len(self._way) > 1 and math.dist(self._way[0], robot[:2]) < 0.3:
            self._way.pop(0)
        towards = math.atan2(self._way[0][1] - robot.y, self._way[0][0] - robot.x)
        error = math.remainder(towards - robot.yaw, math.tau)
        if abs(error) > 0.3:
            self._blocked_s = 0.0
            self._got_on = (seconds, robot)
            return 0.0, math.copysign(min(1.2, 0.3 + 1.2 * abs(error)), error)
        if math.dist(self._got_on[1][:2], robot[:2]) > 0.05:
            self._got_on = (seconds, robot)
        if state.forward.allowed > 0.0 and seconds - self._got_on[0] < _STUCK_S:
            self._blocked_s = 0.0
            return 0.5, 1.5 * error
        self._blocked_s += 0.04
        if self._blocked_s > 0.6:
            self._note(robot, state.forward.sensor)
            self._blocked_s = 0.0
            self._backed_from, self._until = robot[:2], seconds + 2.5
            self._got_on = (seconds, robot)
        return 0.3, 0.0

    def _note(self, robot: Pose, sensor: str) -> None:
        aside = ULTRASONIC[sensor].y if sensor in ULTRASONIC else 0.0
        cos, sin = math.cos(robot.yaw), math.sin(robot.yaw)
        self._noted.append((robot.x + 0.62 * cos - aside * sin, robot.y + 0.62 * sin + aside * cos))

    def _planned(self, robot: Pose) -> list[tuple[float, float]]:
        """The way that keeps farthest off what was noted, as far as there is one."""
        here, last = cell_of(robot.x, robot.y), round(SIZE / _CELL)
        for radius in (0.55, 0.5, 0.45, 0.4, 0.35, 0.3, 0.2, 0.1):

            def cost(cell: Cell, radius: float = radius) -> float:
                if not (0 <= cell[0] <= last and 0 <= cell[1] <= last):
                    return math.inf
                point = (cell[0] * _CELL, cell[1] * _CELL)
                if all(math.dist(point, noted) >= radius for noted in self._noted):
                    return 1.0
                return 5.0 if math.dist(cell, here) <= 3.0 else math.inf  # out of where it stands now

            if way := shortest(here, cell_of(*EXIT), cost):
                return [(x * _CELL, y * _CELL) for x, y in [*way[3::3], way[-1]]]
        return [EXIT]


class Crossing(msgspec.Struct, frozen=True):
    """What became of a room."""

    reached: bool
    seconds: float
    contacts: int
    towards_an_echo: int
    """Contacts against invariant (e): of a robot driven towards what had echoed in the last two cycles, and was closer
    than its stopping distance, 40 ms after that echo."""
    why: str


def cross(seed: int) -> Crossing | None:
    """Drive through the room of this seed; None where no disc of the footprint and its margin gets through."""
    room = cluttered(seed)
    if not has_way(room):
        return None
    with closed_loop(room, sim=SimConfig(), seed=seed, truth=drawn(seed)) as loop:
        spare_time(loop)
        arm(loop)
        world = loop.simulation.world
        for sonar in world.sonars.values():
            sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, WILD_SHARE
        heard = _Heard(loop)
        world.hand = Explorer(loop)
        contacts = towards = 0
        until = loop.simulation.now_us + round(PATIENCE * 1e6)
        while math.dist(world.plant.pose[:2], EXIT) > AT_EXIT and loop.simulation.now_us < until:
            loop.step()
            heard.listen()
            if world.plant.contacts > contacts:
                contacts = world.plant.contacts
                towards += heard.drives_into_an_echo()
        return Crossing(
            reached=math.dist(world.plant.pose[:2], EXIT) <= AT_EXIT,
            seconds=loop.simulation.now_us * 1e-6,
            contacts=contacts,
            towards_an_echo=towards,
            why=f"{world.plant.pose} forward: {loop.newest['guard'].forward}",
        )


def crossings(seeds: Iterable[int]) -> dict[int, Crossing]:
    """What becomes of these rooms, by seed; none where there is no way."""
    return {seed: crossing for seed in seeds if (crossing := cross(seed)) is not None}


class _Heard:
    """The last two echoes of each sensor that invariant (e) speaks of: of a surface in the cone, up to 25° slanted."""

    def __init__(self, loop: ClosedLoop) -> None:
        self._loop = loop
        self._echoes: dict[str, deque[_Echo]] = defaultdict(lambda: deque(maxlen=2))
        self._newest: dict[str, Any] = {}

    def listen(self) -> None:
        world = self._loop.simulation.world
        for sensor, pose in ULTRASONIC.items():
            reading = self._loop.newest[f"range/{sensor}"]
            if reading is self._newest.get(sensor):
                continue
            self._newest[sensor] = reading
            sonar = world.sonars[pose.index]
            origin = sonar.origin(world.plant.pose)
            seen = math.inf  # a wild reading, or none, is of nothing
            for hit in sonar.hits(origin):
                incidence = hit.incidence if hit.round else world.room.incidence(hit.surface, origin.yaw)
                if incidence >= _SURE and reading.range is not None and abs(hit.distance - reading.range) < NEARLY:
                    seen = reading.range
            self._echoes[sensor].append(_Echo(seen, world.plant.path_length, self._loop.simulation.now_us))

    def drives_into_an_echo(self) -> bool:
        """Whether the robot is driven on, though the guard has had the time to stop it."""
        plant, now_us = self._loop.simulation.world.plant, self._loop.simulation.now_us
        let_through = self._loop.newest["cmd_vel"].linear_x
        speed = (plant.left.speed + plant.right.speed) / 2.0
        stops_after = abs(speed) * 0.1 + speed * speed / 3.0
        for sensor, pose in ULTRASONIC.items():
            if let_through * math.cos(pose.yaw) <= 0.0:
                continue
            for echo in self._echoes[sensor]:
                came = plant.path_length - echo.path
                away = echo.seen + abs(pose.x) - ROBOT.footprint_radius - came
                if away <= stops_after and now_us - echo.now_us > _REACTION_US:
                    return True
        return False


class _Echo(NamedTuple):
    seen: float
    """m; infinite where nothing was."""
    path: float
    """m the robot had come."""
    now_us: int
