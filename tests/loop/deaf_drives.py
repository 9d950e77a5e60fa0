"""What the drives with deaf sensors are drawn from: rooms, which sensors, and what the hand does until one is deaf."""

import math
import random
from collections.abc import Mapping
from typing import Final, Literal, TypeVar

import msgspec

from giraff_maps.room_file import Point
from giraff_sim.world.room import Pose, Room
from tests.loop.rooms import cluttered
from tests.support.robots import ULTRASONIC

_LEAST: Final = 0.4  # m from the robot's middle to what is nearest
_DEAF: Final = {
    ("front_left",): 1.0,
    ("front_right",): 1.0,
    ("front_left", "front_right"): 2.0,
    ("rear",): 1.0,
    ("front_left", "front_right", "rear"): 0.6,
}
_ROOMS: Final = {"wall": 3.0, "box": 1.5, "posts": 1.0, "corner": 1.0, "corridor": 1.0, "cluttered": 1.5, "open": 1.5}
_HEARD: Final = 0.6  # s, at the least, before a sensor is deaf: it is noted what it heard
_SLANTED: Final = 0.07  # share of the drives
_FLICKERING: Final = 0.12  # share of them
_HEARD_OF: Final = ((True, False), (True, False, False), (True, True, False))
"""Which pings a membrane that comes off still hears, again and again."""
_STORIES: Final = {"driving": 1.5, "parked": 1.0, "backed up": 1.0, "turned": 1.0, "mixed": 1.0}

_Drawn = TypeVar("_Drawn")

What = Literal["drive", "park", "cover", "back", "turn", "curve", "push"]


class Act(msgspec.Struct, frozen=True):
    """One thing that a hand does."""

    what: What
    """`cover` is what makes the sensors deaf; `push`: drive on, turning and backing up a little where nothing moves."""
    amount: float = 0.0
    """m to drive or to back up, rad to turn to the left, s to park or to push."""

    def __str__(self) -> str:
        match self.what:
            case "cover":
                return "cover"
            case "turn" | "curve":
                return f"{self.what} {math.degrees(self.amount):.0f}°"
            case "park" | "push":
                return f"{self.what} {self.amount:.0f} s"
            case "drive" | "back":
                return f"{self.what} {self.amount:.1f} m"


class Drive(msgspec.Struct, frozen=True):
    """Drawn from a seed."""

    seed: int
    room: str
    """What kind of a room."""
    deaf: tuple[str, ...]
    sign: float
    """1: drives forward; -1: backward."""
    acts: tuple[Act, ...]
    is_wild: bool
    """One reading in twenty of the sound sensors is wild."""
    keeps_heading: bool
    """The hand steers against motors that are unlike each other, as one does that looks."""
    hears: tuple[bool, ...] = ()
    """Which pings the sensors that are to be deaf hear before that, in turn; empty: all of them."""

    def __str__(self) -> str:
        way = "forward" if self.sign > 0.0 else "backward"
        hears = f" (before: {''.join('E' if echo else '-' for echo in self.hears)})" if self.hears else ""
        acts = ", ".join(str(act) for act in self.acts)
        return f"{self.room}, {way}, {' and '.join(self.deaf)} deaf{hears}: {acts}"


def drawn_drive(seed: int) -> tuple[Drive, Room]:
    """The drive of this seed, and where."""
    choose = random.Random(f"{seed}/deaf")
    deaf = _one_of(choose, _DEAF)
    sign = choose.choice([sign for sign in (1.0, -1.0) if any(sign * math.cos(ULTRASONIC[n].yaw) > 0.0 for n in deaf)])
    kind = _one_of(choose, _ROOMS)
    room, way = _room(choose, kind, seed, sign)
    acts = _from_the_open(choose) if kind == "open" else _story(choose, _one_of(choose, _STORIES), way)
    slanted = random.Random(f"{seed}/slanted")
    if slanted.random() < _SLANTED:
        kind, (room, acts) = "slanted", _slanted(slanted, sign)
    flicker = random.Random(f"{seed}/flicker")
    push = Act("push", choose.triangular(25.0, 60.0, 25.0))
    drive = Drive(
        seed=seed,
        room=kind,
        deaf=deaf,
        sign=sign,
        acts=(*acts, push),
        is_wild=choose.random() < 0.4,
        keeps_heading=choose.random() < 0.7,
        hears=flicker.choice(_HEARD_OF) if flicker.random() < _FLICKERING else (),
    )
    return drive, room


def _one_of(choose: random.Random, weights: Mapping[_Drawn, float]) -> _Drawn:
    return choose.choices(list(weights), list(weights.values()))[0]


def _story(choose: random.Random, kind: str, way: float) -> list[Act]:
    """`way`: m to what is ahead."""
    towards = [Act("drive", choose.uniform(0.0, way))]
    match kind:
        case "driving":
            return [*towards, Act("cover")]
        case "parked":
            return [*(towards if choose.random() < 0.5 else []), *_parked(choose)]
        case "backed up":
            far = choose.uniform(0.2, 1.5)
            before = choose.choice((0.0, 0.0, choose.uniform(0.0, far)))
            up_to = Act("drive", choose.choice((choose.uniform(0.0, way), way + 1.0)))
            return [up_to, *_backed(before), Act("cover"), *_backed(far - before)]
        case "turned":
            return [*towards, Act("cover"), *_turned(choose)]
    first, second = choose.sample(("parked", "backed up", "turned"), 2)
    acts = {
        "parked": [Act("park", choose.uniform(0.0, 25.0))],
        "backed up": _backed(choose.uniform(0.2, 1.5)),
        "turned": _turned(choose),
    }
    on = [Act("drive", choose.uniform(0.0, 1.5))] if choose.random() < 0.5 else []
    return [*towards, Act("cover"), *acts[first], *on, *acts[second]]


def _parked(choose: random.Random) -> list[Act]:
    seconds = choose.uniform(0.0, 45.0)
    covered = choose.choice((0.0, seconds, choose.uniform(0.0, seconds), choose.uniform(0.0, seconds)))
    return [Act("park", max(_HEARD, covered)), Act("cover"), Act("park", seconds - covered)]


def _backed(far: float) -> list[Act]:
    return [Act("back", far)] if far > 0.0 else []


def _turned(choose: random.Random) -> list[Act]:
    angle = math.radians(choose.uniform(20.0, 180.0)) * choose.choice((-1.0, 1.0))
    turn = Act("turn" if choose.random() < 0.7 else "curve", angle)
    if choose.random() < 0.6:
        return [turn]
    on = [Act("drive", choose.uniform(0.1, 2.0))] if choose.random() < 0.5 else []
    return [turn, *on, Act("turn", -angle)]


def _from_the_open(choose: random.Random) -> list[Act]:
    """Away from the wall that is heard at first, into the open, and deaf on the way."""
    away = Act("turn", math.radians(choose.uniform(100.0, 180.0)) * choose.choice((-1.0, 1.0)))
    on = Act("drive", choose.uniform(0.0, 6.0))
    return choose.choice(([away, on, Act("cover")], [Act("cover"), away], [away, on, *_parked(choose)]))


def _slanted(choose: random.Random, sign: float) -> tuple[Room, list[Act]]:
    """A wall that is heard at the edge of a cone, and turned to squarely, or nearly, once the sensors are deaf."""
    room = Room("slanted", Pose(0.0, 0.0, 0.0 if sign > 0.0 else math.pi))
    slant = math.radians(choose.uniform(5.0, 25.0)) * choose.choice((-1.0, 1.0))
    _add(room, "wall", (choose.uniform(1.0, 2.4), 0.0), slant, [(0.0, -4.0), (0.0, 4.0)])
    return room, [Act("park", _HEARD), Act("cover"), Act("turn", slant * choose.uniform(0.6, 1.2))]


def _room(choose: random.Random, kind: str, seed: int, sign: float) -> tuple[Room, float]:
    """And how many m it is to what the robot drives at."""
    while True:
        if kind == "cluttered":
            room = cluttered(choose.randrange(1_000_000))
            room.start = Pose(room.start.x, room.start.y, choose.uniform(-0.3, 0.3) + math.pi / 4.0)
            if sign < 0.0:
                room.start = Pose(room.start.x, room.start.y, room.start.yaw - math.pi)
            way = choose.uniform(1.0, 4.0)
        else:
            room = Room(f"{kind} {seed}", Pose(0.0, 0.0, 0.0 if sign > 0.0 else math.pi))
            way = _furnish(choose, room, kind)
        if room.clearance(*room.start[:2]) >= _LEAST:
            return room, way


def _furnish(choose: random.Random, room: Room, kind: str) -> float:
    """What is named so, along x."""
    half = choose.uniform(6.3, 8.0) if kind == "open" else choose.uniform(4.6, 8.0)
    room.add_wall("walls", [(half, half), (-half, half), (-half, -half), (half, -half)], closed=True)
    way = choose.uniform(0.75, 4.3)
    match kind:
        case "wall" | "open":
            _wall(choose, room, (way, choose.uniform(-0.5, 0.5)))
        case "box":
            _box(choose, room, (way + 0.4, choose.uniform(-0.4, 0.4)))
        case "posts":
            for number in range(choose.randint(1, 3)):
                place = way + choose.uniform(0.0, 0.5), choose.uniform(-0.4, 0.4)
                room.add_post(f"post {number}", *place, choose.uniform(0.03, 0.2))
        case "corner":
            _corner(choose, room, (way, choose.uniform(-0.4, 0.4)))
        case "corridor":
            way = choose.uniform(1.0, 4.3)
            slant = math.radians(choose.uniform(-15.0, 15.0))
            left, right = choose.uniform(0.5, 1.3), choose.uniform(0.5, 1.3)
            ends = [(-1.0, left), (way, left), (way, -right), (-1.0, -right)]
            room.add_wall("corridor", [_turned_by(point, slant) for point in ends])
    if kind != "open" and choose.random() < 0.5:
        behind = -choose.uniform(1.5, 3.5)
        room.add_wall("behind", [(behind, -1.5), (behind, 1.5)])
    if choose.random() < 0.25:
        for number in range(choose.randint(1, 3)):
            place = choose.uniform(0.8, 4.0), choose.uniform(-2.0, 2.0)
            room.add_post(f"leg {number}", *place, choose.uniform(0.02, 0.1))
    return way


def _wall(choose: random.Random, room: Room, middle: Point) -> None:
    """Across, slanted by up to 25 degrees, and some more than any sensor hears."""
    most = 25.0 if choose.random() < 0.85 else 45.0
    slant, half = math.radians(choose.uniform(-most, most)), choose.uniform(0.8, 4.0)
    _add(room, "wall", middle, slant, [(0.0, -half), (0.0, half)])


def _box(choose: random.Random, room: Room, middle: Point) -> None:
    deep, wide = choose.uniform(0.1, 0.4), choose.uniform(0.15, 0.6)
    points = [(-deep, -wide), (deep, -wide), (deep, wide), (-deep, wide)]
    most = 25.0 if choose.random() < 0.6 else 180.0
    _add(room, "box", middle, math.radians(choose.uniform(-most, most)), points, closed=True)


def _corner(choose: random.Random, room: Room, apex: Point) -> None:
    """Two walls that meet: towards the robot, or away from it."""
    opening = choose.uniform(0.4, 0.95) * math.pi
    towards = math.pi if choose.random() < 0.7 else 0.0
    ends = [
        (3.0 * math.cos(towards + side * opening), 3.0 * math.sin(towards + side * opening)) for side in (-0.5, 0.5)
    ]
    _add(room, "corner", apex, math.radians(choose.uniform(-25.0, 25.0)), [ends[0], (0.0, 0.0), ends[1]])


def _add(room: Room, name: str, middle: Point, turn: float, points: list[Point], *, closed: bool = False) -> None:
    turned = [_turned_by(point, turn) for point in points]
    room.add_wall(name, [(middle[0] + x, middle[1] + y) for x, y in turned], closed=closed)


def _turned_by(point: Point, angle: float) -> Point:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * point[0] - sin * point[1], sin * point[0] + cos * point[1]
