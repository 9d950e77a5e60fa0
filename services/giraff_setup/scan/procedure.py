"""Leads a person and the robot: once round on the spot, 1 m straight on, and then, if wanted, before a wall."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Final, NamedTuple, Protocol

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import LaserScanner
from giraff_maps.scan.match import Floats, points_of, rotated
from giraff_schemas.motion import Move, Turn
from giraff_schemas.scan import NOT_MEASURED, OWN, RAYS, LaserScan
from giraff_setup.scan.fit import (
    BIAS_SD,
    FEWEST,
    STEP_SD,
    Mount,
    ScanTurn,
    mount_by_motion,
    mount_by_step,
    own_parts,
    turns_with_wheels,
)
from giraff_setup.ultrasonic.calibrate import HeldRest
from giraff_setup.ultrasonic.fit import UntoldError
from giraff_setup.ultrasonic.procedure import StoppedError, ask_number, has_moved
from giraff_tools.terminal.human import Human, agrees

_HEADINGS: Final = 36
_LEGS: Final = 10
_LEG: Final = 0.1  # m
_ROOM: Final = 1.5  # m that must be free before the robot
_BESIDE: Final = 0.05  # m to either side of the robot that must be free, too
_TURNS: Final = 20  # of the scanner before the wall
_BACK: Final = math.radians(20.0)  # half of the arc behind the robot that nothing of its own may hide
_ASIDE: Final = math.radians(135.0)

_FREE: Final = f"""\
The robot now turns once round on the spot and then drives {_LEGS * _LEG:g} m straight on, in small steps. Is the way
{_ROOM:g} m ahead of it free, and the place round it? [yes/no]"""
_BOOK: Final = """\
Lay a book of 20 to 60 mm upright at a bare, flat wall, to the left of the robot's middle line, its edge on that line.
Park the robot square before the wall, 0.6 to 1.3 m away; nothing may stand between."""
_ROUND: Final = """\
Once more with its back to the wall, which tells the bias of its ranges? The robot then turns round on the spot: the
place round it must be free. [yes/no]"""


class ScannedRobot(HeldRest, Protocol):
    """A robot with a laser scanner."""

    def scan(self, turns: int) -> list[LaserScan]:
        """Return so many turns that begin from now on, or what came in time. Raises StoppedError."""
        ...


class Surveyed(NamedTuple):
    """Mount and own parts of a scanner."""

    name: str
    mount: Mount
    upside_down: bool
    own: list[tuple[float, float]]
    words: list[str]
    """Gross errors of the file."""


def survey(human: Human, stand: ScannedRobot, scanners: Mapping[str, LaserScanner], radius: float) -> Surveyed:
    """Find where the scanner that is heard sits. Raises StoppedError, UntoldError and NobodyError.

    `radius`: m of the robot's footprint.
    """
    [scan] = _scans(stand, 1)
    name = scan.sensor
    if name not in scanners:
        raise StoppedError(f'{name} is heard, and the robot file has no [robot.sensors.{name}] of the type "ld19"')
    filed = scanners[name]
    if (scan.bearing, scan.step > 0.0) != (filed.yaw, filed.upside_down):
        raise StoppedError(
            f"giraff_scan goes by another yaw or upside_down of {name} than this robot file; copy the file to its "
            "machine, and restart the robot's services at rest"
        )
    first, place = _rest(stand, filed)
    if (free := _free_ahead(first, filed, radius)) < _ROOM:
        raise StoppedError(
            f"only {free:.1f} m are free ahead by the scan, and it needs {_ROOM:g} m; let the robot look where more is "
            f"free, or correct yaw and upside_down of [robot.sensors.{name}]"
        )
    if not agrees(human, _FREE, stand.idle):
        raise StoppedError("not begun; clear the way, then call it again")
    turns, places, words = [first], [place], list[str]()
    for told, count, step in (
        ("It turns once round, which takes about a minute.", _HEADINGS, Turn(angle=math.tau / _HEADINGS)),
        ("It drives straight on.", _LEGS, Move(distance=_LEG)),
    ):
        human.show(told)
        for _ in range(count):
            stand.perform([step])
            turn, place = _rest(stand, filed)
            turns.append(turn)
            places.append(place)
    yaws = [place.yaw for place in places]
    if flipped := not turns_with_wheels(turns[: _HEADINGS + 1], yaws):
        turns = [turn.mirrored() for turn in turns]
        now = "the right way up" if filed.upside_down else "upside down"
        words.append(f"{name} hangs {now}, other than the file says.")
    own = own_parts(turns[:_HEADINGS])
    driven = sum(math.dist(a[:2], b[:2]) for a, b in pairwise(places[_HEADINGS:]))
    mount = mount_by_motion([turn.without(own) for turn in turns], yaws, _HEADINGS, driven)
    if abs(math.remainder(mount.yaw - filed.yaw, math.tau)) > _ASIDE:
        words.append(f"{name} looks backward, seen from where the file has its zero: it is turned by 180 degrees.")
    return Surveyed(name, mount, filed.upside_down is not flipped, own, words)


def check(human: Human, stand: ScannedRobot, filed: LaserScanner, found: Surveyed) -> tuple[Mount, float | None] | None:
    """Measure the mount before a wall with a step; return it, and the bias of the ranges (m; None: not known).

    None: it is not wanted, or cannot be told. Raises StoppedError and NobodyError.
    """
    while agrees(human, "Check it before a wall with a step? [yes/no]", stand.idle):
        human.show(_BOOK)
        try:
            facing = _before_wall(human, stand, filed, found, is_behind=False)
            back = math.pi - found.mount.yaw + _BACK
            if any((back - begin) % math.tau < end - begin + 2.0 * _BACK for begin, end in found.own):
                human.show("The robot's own parts hide what is behind it, so that its back is not turned to the wall.")
            elif agrees(human, _ROUND, stand.idle):
                try:
                    stand.perform([Turn(angle=math.pi)])
                except StoppedError as error:
                    human.show(f"It did not turn round: {error}. Turn it yourself.")
                human.show("Park it square again, its back to the wall, the edge of the book on its middle line.")
                behind = _before_wall(human, stand, filed, found, is_behind=True)
                yaw = facing.yaw + math.remainder(behind.yaw - facing.yaw, math.tau) / 2.0
                sds = (sd / math.sqrt(2.0) for sd in STEP_SD)
                mean = Mount((facing.x + behind.x) / 2.0, (facing.y + behind.y) / 2.0, yaw, *sds)
                return mean, (behind.x - facing.x) / 2.0
            return facing._replace(x_sd=math.hypot(STEP_SD[0], BIAS_SD)), None
        except UntoldError as error:
            human.show(f"This check does not tell: {error}.")
    return None


def _before_wall(human: Human, stand: ScannedRobot, filed: LaserScanner, found: Surveyed, *, is_behind: bool) -> Mount:
    distance = ask_number(human, "From the wall to the middle between the wheels, along the floor:", stand.idle)
    seen = [_seen(scan, filed) for scan in _scans(stand, _TURNS)]
    turns = seen if found.upside_down is filed.upside_down else [turn.mirrored() for turn in seen]
    return mount_by_step([turn.without(found.own) for turn in turns], distance, found.mount, is_behind=is_behind)


def _rest(stand: ScannedRobot, filed: LaserScanner) -> tuple[ScanTurn, Pose]:
    """Return a turn of the scanner while the robot rests, and odometry's pose."""
    before, [scan], after = stand.place(), _scans(stand, 1), stand.place()
    if has_moved(before, after):
        raise StoppedError("the robot moved while it was to rest; see that nobody drives it, and begin again")
    seen = _seen(scan, filed)
    if (count := len(seen.without(()).ranges)) < FEWEST:
        raise UntoldError(
            f"only {count} of {RAYS} rays have an echo; take a furnished room with light walls within 8 m, and see "
            "that the scanner's window is clean"
        )
    return seen, after


def _scans(stand: ScannedRobot, turns: int) -> list[LaserScan]:
    scans = stand.scan(turns)
    if trouble := next((scan.trouble for scan in scans if scan.trouble), None):
        raise StoppedError(f"the laser scanner: {trouble}")
    if len(scans) < turns:
        raise StoppedError("the laser scanner is silent; check giraff_scan, and the scanner's cable")
    return scans


def _seen(scan: LaserScan, filed: LaserScanner) -> ScanTurn:
    """Return a turn in the scanner's frame, as the file has it."""
    rays = np.array(scan.rays(), dtype=int)
    ranges: Floats = np.where(rays == NOT_MEASURED, 0, rays % OWN).astype(float) / 1000.0
    ranges[ranges > filed.reach] = 0.0
    return ScanTurn(scan.bearing + scan.step * np.arange(RAYS, dtype=float) - filed.yaw, ranges)


def _free_ahead(seen: ScanTurn, filed: LaserScanner, radius: float) -> float:
    """Return m from the robot's front to what it sees there."""
    angles, ranges = seen.without(filed.own or ())
    x, y = rotated(filed.yaw, points_of(angles, ranges)).T + np.array([[filed.x], [filed.y]])
    return float(x[(x > radius) & (np.abs(y) < radius + _BESIDE)].min(initial=math.inf) - radius)
