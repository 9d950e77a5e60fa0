"""How useful the robot is, in figures: an empty hall, a person who walks off, the demonstration, cluttered rooms.

Usage: python -m tests.loop.useful [rooms FROM TO [--out FILE]]: prints the figures of halls, persons and demonstration
as JSON; with `rooms` what each of these rooms takes, by seed, so that two guards can be compared room by room.
"""

import argparse
import json
import math
import random
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import msgspec

from giraff_sim.board import ROOT
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.truth import draw_truth
from giraff_sim.world.bno055 import GRAVITY, Vector
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.room import Pose, Room, read_room
from tests.loop.loops import arm, closed_loop, spare_time
from tests.loop.reaction import quantile, tilted
from tests.loop.rooms import crossings
from tests.support.robots import ROBOT, ULTRASONIC

SEEDS: Final = range(6)
PASSING_SEEDS: Final = range(40)
"""With one in six of them, an echo that was remembered beside the person holds the robot for ten seconds."""
DEMO_SEEDS: Final = range(24)
"""The robots and hands of the demonstration differ by a tenth: fewer do not show a change of a twentieth."""
HALL: Final = (10.0, 6.0)  # m, along and across
LARGE_HALL: Final = (40.0, 40.0)
WAY: Final = 10.0  # m, in the large one
DEMO_S: Final = 60.0
HALL_S: Final = 50.0  # s that the hall may take
PASSED_S: Final = 16.0  # s until who walked off is passed
RELEASE_MEDIAN_S: Final = 0.72
RELEASE_S: Final = 1.0
"""s until the robot moves for who walked off before a wall, the median of 40 and the most: 0.1 s more than with a guard
that trusts a sensor for 30 s, or 5 m, after its last echo."""
DEMO_SPEED: Final = 0.2397
"""m/s with that guard, the mean of 24."""
_PATIENCE: Final = 200.0  # s
_WALL_BEHIND: Final = 3.0  # m, behind a person
_FULL_TILT: Final = 7.0  # m/s² forward: full speed by a sensor with an offset, too
_FROM_WALL: Final = 0.6  # m from the footprint to the end wall that the robot faces first
_FACES_IT: Final = 0.1  # rad
_AT_REST: Final = (0.005, 0.5)  # m/s, and s
_STOPPED_BY: Final = 0.6  # m: what is farther away did not stop it
_SCREEN: Final = 3.5  # m from the middle: proves the sensors, and is taken away
_BODY: Final = 0.15  # m, radius of a person
_AHEAD: Final = 0.7  # m from the front sensors to a person who steps in
_ASIDE: Final = 0.2  # m to either side, at the most
_STANDS_S: Final = 3.0
_WALK: Final = 1.0  # m/s
_STRIDE_S: Final = 0.02
_PAST: Final = 0.3  # m


class Walker:
    """A hand that turns the robot towards a place, then drives there at full tilt, whatever the robot does."""

    trembles = True

    def __init__(self, x: float, y: float) -> None:
        self._towards = (x, y)
        self._turned = False

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del seconds
        x, y = self._towards
        error = math.remainder(math.atan2(y - robot.y, x - robot.x) - robot.yaw, math.tau)
        self._turned = self._turned or abs(error) < _FACES_IT
        if not self._turned:
            spin = math.copysign(0.3 + min(0.9, 1.2 * abs(error)), error)
            return tilted(0.0, spin).acceleration(0.0, robot)
        left = tilted(0.0, max(-0.4, min(0.4, 1.5 * error))).acceleration(0.0, robot)[1]
        return _FULL_TILT, left, math.sqrt(GRAVITY**2 - _FULL_TILT**2 - left**2)


class Hall(msgspec.Struct, frozen=True):
    """A way through an empty hall."""

    seconds: float
    """From the beginning of the turn: until the far wall has stopped the robot, or until it has come `WAY` m."""
    rest: float
    """m from the footprint to the nearest wall at the end."""
    contacts: int


class Passing(msgspec.Struct, frozen=True):
    """A person who stood in the way walks off. s from when they begin to."""

    moves: float
    """Until the robot moves."""
    passed: float
    """Until its centre is 0.3 m past where the person's was."""
    contacts: int


def hall(seed: int, length: float = HALL[0]) -> Hall:
    """From one end of an empty hall to the other."""
    with _hall(seed, length, HALL[1]) as loop:
        began_us, still_us = loop.simulation.now_us, 0
        plant = loop.simulation.world.plant
        speed, seconds = _AT_REST
        while still_us < seconds * 1e6:
            loop.step()
            at_the_end = plant.pose.x > length / 2.0 and plant.clearance < _STOPPED_BY
            still = at_the_end and max(abs(plant.left.speed), abs(plant.right.speed)) < speed
            still_us = still_us + loop.simulation.world.step_us if still else 0
            _be_patient(loop, began_us)
        return Hall((loop.simulation.now_us - still_us - began_us) * 1e-6, plant.clearance, plant.contacts)


def large_hall(seed: int) -> Hall:
    """Ten metres of way in a hall of 40 m, where only the end wall behind the robot has ever been heard."""
    with _hall(seed, *LARGE_HALL) as loop:
        began_us = loop.simulation.now_us
        plant = loop.simulation.world.plant
        while math.dist(plant.pose[:2], loop.simulation.world.room.start[:2]) < WAY:
            loop.step()
            _be_patient(loop, began_us)
        return Hall((loop.simulation.now_us - began_us) * 1e-6, plant.clearance, plant.contacts)


def walks_off(seed: int, *, into_the_open: bool) -> Passing:
    """A person steps in before the driving robot, stands for 3 s and walks off: ahead and aside into the open, or to
    the side where a wall is 3 m behind. The hand asks for full speed all the time."""
    choose = random.Random(f"{seed}/walks off")
    room = Room("open", Pose(0.0, 0.0, 0.0))
    room.add_wall("screen", [(_SCREEN, -3.0), (_SCREEN, 3.0)])
    with _calibrated(room, seed) as loop:
        arm(loop)
        plant = loop.simulation.world.plant
        room.remove("screen")
        loop.simulation.world.hand = Walker(1000.0, 0.0)
        loop.run(choose.uniform(1.5, 2.0))
        side = choose.choice((-1.0, 1.0))
        sensors = max(pose.x for pose in ULTRASONIC.values())
        x, y = plant.pose.x + sensors + _AHEAD + _BODY, plant.pose.y + choose.uniform(-_ASIDE, _ASIDE)
        room.add_post("person", x, y, _BODY)
        if not into_the_open:
            room.add_wall("wall", [(x + _WALL_BEHIND, -10.0), (x + _WALL_BEHIND, 10.0)])
        loop.run(_STANDS_S)
        while _speed(loop) >= _AT_REST[0]:
            loop.step()
        began_us = loop.simulation.now_us
        bearing = side * math.radians(45.0 if into_the_open else 90.0)
        moves: float | None = None
        strides = 0
        while plant.pose.x < x + _PAST:
            loop.step()
            since = (loop.simulation.now_us - began_us) * 1e-6
            if since >= strides * _STRIDE_S and "person" in room.names:
                strides += 1
                walked = _WALK * strides * _STRIDE_S
                room.remove("person")
                if walked < 10.0:
                    room.add_post("person", x + walked * math.cos(bearing), y + walked * math.sin(bearing), _BODY)
            if moves is None and _speed(loop) >= 0.01:
                moves = since
            _be_patient(loop, began_us)
        assert moves is not None
        return Passing(moves, (loop.simulation.now_us - began_us) * 1e-6, plant.contacts)


def demo_speed(seed: int, seconds: float = DEMO_S) -> float:
    """m/s, in the mean: of what `giraff run` shows, from its start."""
    room = read_room(ROOT / "deploy" / "worlds" / "living_room.toml")
    with _calibrated(room, seed) as loop:
        loop.simulation.world.hand = DemoHand(room.waypoints, seed)
        loop.run(seconds)
        return loop.simulation.world.plant.path_length / seconds


def figures() -> dict[str, float]:
    """All but the rooms."""
    halls, large = [hall(seed) for seed in SEEDS], [large_hall(seed) for seed in SEEDS]
    in_the_open = [walks_off(seed, into_the_open=True) for seed in PASSING_SEEDS]
    before_a_wall = [walks_off(seed, into_the_open=False) for seed in PASSING_SEEDS]
    passed = [[each.passed for each in passings] for passings in (in_the_open, before_a_wall)]
    moves = [each.moves for each in before_a_wall]
    speeds = [demo_speed(seed) for seed in DEMO_SEEDS]
    return {
        "halls": len(halls),
        "hall_max_s": round(max(each.seconds for each in halls), 1),
        "large_hall_10_m_max_s": round(max(each.seconds for each in large), 1),
        "persons_each": len(PASSING_SEEDS),
        "passed_in_the_open_median_s": round(quantile(passed[0], 0.5), 1),
        "passed_in_the_open_max_s": round(max(passed[0]), 1),
        "passed_before_a_wall_median_s": round(quantile(passed[1], 0.5), 1),
        "passed_before_a_wall_max_s": round(max(passed[1]), 1),
        "moves_before_a_wall_median_s": round(quantile(moves, 0.5), 2),
        "moves_before_a_wall_max_s": round(max(moves), 2),
        "demonstrations": len(speeds),
        "demonstration_m_s": round(sum(speeds) / len(speeds), 4),
        "contacts": sum(each.contacts for each in (*halls, *large))
        + sum(each.contacts for each in (*in_the_open, *before_a_wall)),
    }


@contextmanager
def _calibrated(room: Room, seed: int) -> Iterator[ClosedLoop]:
    truth = draw_truth("calibrated", SimConfig().truth, seed)
    with closed_loop(room, sim=SimConfig(), seed=seed, truth=truth) as loop:
        spare_time(loop)
        yield loop


@contextmanager
def _hall(seed: int, length: float, width: float) -> Iterator[ClosedLoop]:
    """A robot that has faced one end wall of a hall, from x = 0 to `length`, and is now to turn and go to the other."""
    begin = ROBOT.footprint_radius + _FROM_WALL
    room = Room("hall", Pose(begin, 0.0, math.pi))
    half = width / 2.0
    room.add_wall("walls", [(0.0, -half), (length, -half), (length, half), (0.0, half)], closed=True)
    with _calibrated(room, seed) as loop:
        arm(loop)
        loop.simulation.world.hand = Walker(length, 0.0)
        yield loop


def _speed(loop: ClosedLoop) -> float:
    plant = loop.simulation.world.plant
    return abs(plant.left.speed + plant.right.speed) / 2.0


def _be_patient(loop: ClosedLoop, began_us: int) -> None:
    waited = (loop.simulation.now_us - began_us) * 1e-6
    assert waited < _PATIENCE, f"{loop.simulation.world.plant.pose} forward: {loop.newest['guard'].forward}"


def _print_rooms(seeds: Sequence[int], out: Path | None) -> None:
    found = crossings(seeds)
    figures = {
        seed: {"seconds": crossing.seconds, "reached": crossing.reached, "contacts": crossing.contacts}
        for seed, crossing in found.items()
    }
    text = json.dumps(figures, indent=1) + "\n"
    if out is None:
        print(text, end="")
        return
    out.write_text(text)
    reached = sum(crossing.reached for crossing in found.values())
    median = quantile([crossing.seconds for crossing in found.values()], 0.5)
    print(f"{reached} of {len(found)} rooms left, {median:.1f} s (median)")


def main(arguments: Sequence[str]) -> None:
    parser = argparse.ArgumentParser(prog="tests.loop.useful", description=__doc__)
    rooms = parser.add_subparsers(dest="what").add_parser("rooms", help="what each of these rooms takes, as JSON")
    rooms.add_argument("first", type=int, metavar="FROM")
    rooms.add_argument("last", type=int, metavar="TO", help="this one, too")
    rooms.add_argument("--out", type=Path, metavar="FILE", help="for the JSON")
    given = parser.parse_args(arguments)
    if given.what is None:
        print(json.dumps(figures(), indent=1))
    else:
        _print_rooms(range(given.first, given.last + 1), given.out)


if __name__ == "__main__":
    main(sys.argv[1:])
