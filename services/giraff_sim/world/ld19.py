"""An LD06 or LD19 laser scanner in the simulated room, as its packets show it; times and errors are the datasheet's.

It needs numpy, so only a robot with a scanner imports it.
"""

import math
import random
import struct
from collections import deque
from enum import StrEnum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from giraff_core.senses import LaserScanner
from giraff_scan.ld19 import MARK, POINTS, POINTS_PER_S, WRAPS_MS, crc8
from giraff_sim.world.world import World

PACKET_US: Final = POINTS * 1e6 / POINTS_PER_S
DELAY_US: Final = 2700.0 + 47 * 10 * 1e6 / 230_400
"""us from the end of a packet's time until its last byte has arrived."""

_PACKET: Final = struct.Struct("<2sHH" + "HB" * POINTS + "HH")
_FULL_SPEED: Final = 3600.0  # deg/s
_RUN_DOWN: Final = 0.5  # s in which a motor without power stops, and in which it is fast again
_NOISE: Final = 0.010  # m
_LOST: Final = 0.005  # share of the points
_SLANTED: Final = math.cos(math.radians(80.0))  # of the incidence: beyond, no light comes back
_JUMP: Final = 0.3  # m between neighbours, of which either may be a mixture of both
_MIXED: Final = 0.3  # share of those
_SHORTEST: Final = 0.02  # m
_REACH: Final = 12.0  # m
_NOTHING: Final = 1e3  # m: farther than any reach
_KEPT: Final = 10  # packets
_BROKEN: Final = 0.05  # share of the bytes
_LID: Final = 0.03  # m
_THIRD: Final = math.radians(60.0)  # to either side

Floats = NDArray[np.float64]


class Ld19Fault(StrEnum):
    """Faults of the scanner."""

    NONE = "none"
    HELD = "held"  # somebody holds the motor: every point looks the same way
    COASTS = "coasts"  # the motor has lost its power
    REPEATS = "repeats"  # it sends its last packets again and again
    BROKEN = "broken"  # a bit of some bytes is wrong
    NO_ECHO = "no_echo"  # it is covered, and no light comes back
    LID = "lid"  # it is covered, and sees what covers it
    THIRD = "third"  # the third of its turn that looks ahead is covered


class Ld19:
    """The device at the end of its cable, on the robot of a world."""

    def __init__(
        self, mount: LaserScanner, world: World, seed: str, *, bias: float = 0.0, noise: float = _NOISE
    ) -> None:
        """`mount`: where it truly sits; `bias`, `noise`: m, error of all ranges, and the standard deviation of each."""
        self.fault = Ld19Fault.NONE
        self._mount = mount
        self._world = world
        self._bias, self._noise = bias, noise
        chance = random.Random(seed)
        self._random = np.random.default_rng(chance.getrandbits(64))
        self._clock_ms = chance.uniform(0.0, WRAPS_MS)
        self._angle = chance.uniform(0.0, 360.0)  # deg clockwise, of the next point
        self._speed = _FULL_SPEED
        self._poses: deque[tuple[float, float, float, float]] = deque()  # us, m, m, rad without jumps
        self._made = self._sent = 0  # packets
        self._packets: deque[bytes] = deque()
        self._kept: deque[bytes] = deque(maxlen=_KEPT)
        self._far_before = _NOTHING
        self._room_version = -1
        self._walls = self._posts = np.empty((0, 0))

    def bytes_until(self, now_us: int) -> bytes:
        """Return the packets that have arrived since the last call. Call it at each step of the world."""
        self._note_pose(now_us)
        arrived = int((now_us - DELAY_US) // PACKET_US)
        if arrived > self._made:
            self._measure(int(now_us // PACKET_US) - self._made)
        data = b"".join(self._packets.popleft() for _ in range(arrived - self._sent))
        self._sent = max(self._sent, arrived)
        return data

    def receive(self, data: bytes) -> int:
        """Take bytes and ignore them: it has no line on which it could hear."""
        return len(data)

    def _note_pose(self, now_us: int) -> None:
        x, y, yaw = self._world.plant.pose
        poses, wanted_us = self._poses, self._made * PACKET_US
        yaw_before = poses[-1][3] if poses else yaw
        poses.append((now_us, x, y, yaw_before + math.remainder(yaw - yaw_before, math.tau)))
        while len(poses) > 1 and poses[1][0] <= wanted_us:
            poses.popleft()

    def _measure(self, count: int) -> None:
        """Make `count` packets of what was there in their time."""
        starts, steps = np.empty(count), np.empty(count)
        for number in range(count):
            self._turn_motor()
            starts[number], steps[number] = self._angle, self._speed / POINTS_PER_S
            self._angle = (self._angle + POINTS * self._speed / POINTS_PER_S) % 360.0
        angles = (starts[:, None] + np.arange(POINTS) * steps[:, None]).ravel()
        sign = 1.0 if self._mount.upside_down else -1.0
        bearings = self._mount.yaw + sign * math.pi / 180.0 * angles
        numbers: Floats = np.arange(POINTS * self._made, POINTS * (self._made + count), dtype=np.float64)
        ranges = self._seen(numbers * 1e6 / POINTS_PER_S, bearings).tolist()
        for number in range(count):
            self._made += 1
            end = angles[POINTS * number + POINTS - 1] % 360.0
            self._send(starts[number], end, ranges[POINTS * number : POINTS * (number + 1)], steps[number])

    def _turn_motor(self) -> None:
        change = _FULL_SPEED / _RUN_DOWN * PACKET_US * 1e-6
        match self.fault:
            case Ld19Fault.HELD:
                self._speed = 0.0
            case Ld19Fault.COASTS:
                self._speed = max(0.0, self._speed - change)
            case _:
                self._speed = min(_FULL_SPEED, self._speed + change)

    def _seen(self, times_us: Floats, bearings: Floats) -> NDArray[np.int64]:
        """Return mm that each point tells; 0: no echo."""
        far, cosines = self._met(times_us, bearings)
        chances = self._random.random((3, len(far)))
        before, after = np.append(self._far_before, far[:-1]), np.append(far[1:], far[-1])
        self._far_before = float(far[-1])
        other = np.where(np.abs(before - far) > _JUMP, before, after)
        is_mixed = (np.abs(other - far) > _JUMP) & (other + far < _NOTHING) & (chances[0] < _MIXED)
        seen = np.where(is_mixed, far + chances[1] * (other - far), far) + self._bias
        is_lost = (far > _REACH) | (cosines < _SLANTED) | (chances[2] < _LOST)
        match self.fault:
            case Ld19Fault.NO_ECHO:
                is_lost[:] = True
            case Ld19Fault.LID:
                seen, is_lost = np.full_like(far, _LID), chances[2] < _LOST
            case Ld19Fault.THIRD:
                is_lost |= np.cos(bearings) > math.cos(_THIRD)
        seen += self._random.normal(0.0, self._noise, len(far))
        return np.where(is_lost, 0, np.rint(np.maximum(seen, _SHORTEST) * 1000.0)).astype(np.int64)

    def _met(self, times_us: Floats, bearings: Floats) -> tuple[Floats, Floats]:
        """Return m to the first surface of each ray from where the robot then was, and the cosine of its incidence."""
        room, mount = self._world.room, self._mount
        if self._room_version != room.version:
            self._room_version = room.version
            self._walls = np.array([wall[1:] for wall in room.walls], float).reshape(-1, 4).T
            self._posts = np.array([post[1:] for post in room.posts], float).reshape(-1, 3).T
        us, xs, ys, yaws = np.array(self._poses).T
        yaw = np.interp(times_us, us, yaws)
        cos, sin = np.cos(yaw), np.sin(yaw)
        x = np.interp(times_us, us, xs) + cos * mount.x - sin * mount.y
        y = np.interp(times_us, us, ys) + sin * mount.x + cos * mount.y
        rays = x[:, None], y[:, None], np.cos(yaw + bearings)[:, None], np.sin(yaw + bearings)[:, None]
        nothing = np.full_like(rays[0], _NOTHING), np.ones_like(rays[0])
        met = walls_met(self._walls, *rays), _posts_met(self._posts, *rays), nothing
        far, cosines = np.hstack([each for each, _ in met]), np.hstack([each for _, each in met])
        first = np.arange(len(far)), far.argmin(axis=1)
        return far[first], cosines[first]

    def _send(self, start: float, end: float, ranges: list[int], step: float) -> None:
        if self.fault is Ld19Fault.REPEATS and self._kept:
            self._packets.append(self._kept[0])
            self._kept.rotate(-1)
            return
        points = [number for mm in ranges for number in (mm, 200 if mm else 0)]
        begin, last = (round(angle * 100.0) % 36000 for angle in (start, end))
        now_ms = int(self._clock_ms + self._world.skew * 1e3 + self._made * PACKET_US * 1e-3) % WRAPS_MS
        body = _PACKET.pack(MARK, round(step * POINTS_PER_S), begin, *points, last, now_ms)
        packet = bytearray(body + bytes((crc8(body),)))
        self._kept.append(bytes(packet))
        if self.fault is Ld19Fault.BROKEN:
            for place in np.flatnonzero(self._random.random(len(packet)) < _BROKEN):
                packet[place] ^= 1 << int(self._random.integers(8))
        self._packets.append(bytes(packet))


def walls_met(walls: Floats, x: Floats | float, y: Floats | float, cos: Floats, sin: Floats) -> tuple[Floats, Floats]:
    """Return m from (x, y), a row each, to each wall in a direction, and the cosine of the incidence there."""
    off_x, off_y, along_x, along_y = walls[0] - x, walls[1] - y, walls[2] - walls[0], walls[3] - walls[1]
    across = cos * along_y - sin * along_x
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (off_x * along_y - off_y * along_x) / across
        part = (off_x * sin - off_y * cos) / across
    is_met = (far >= 0.0) & (part >= 0.0) & (part <= 1.0)
    return np.where(is_met, far, _NOTHING), np.abs(across) / np.hypot(along_x, along_y)


def _posts_met(posts: Floats, x: Floats, y: Floats, cos: Floats, sin: Floats) -> tuple[Floats, Floats]:
    """Return the same of posts."""
    off_x, off_y, radius = posts[0] - x, posts[1] - y, posts[2]
    along = off_x * cos + off_y * sin
    depth = np.sqrt(np.maximum(0.0, radius**2 - (off_x * sin - off_y * cos) ** 2))
    return np.where((along > 0.0) & (depth > 0.0), np.maximum(0.0, along - depth), _NOTHING), depth / radius
