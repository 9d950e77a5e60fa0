"""What happens to the robot of a seed, and the furnished room where it happens."""

import math
from random import Random
from typing import Final

from giraff_sim.dst.faults import machine as machine_faults
from giraff_sim.dst.faults import network as network_faults
from giraff_sim.dst.faults import robot as robot_faults
from giraff_sim.dst.hands import ClutchingHand, RestlessHand
from giraff_sim.dst.simulated_run import SECONDS, SIM, Begin, Kind, Scenario, ScheduledFault
from giraff_sim.truth import draw_truth
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.hand import Hand
from giraff_sim.world.room import Pose, Room

KINDS: Final[tuple[Kind, ...]] = (*network_faults.KINDS, *machine_faults.KINDS, *robot_faults.KINDS)

_FAULTS: Final = (1, 5)
_RESTS_FROM: Final = 0.9  # s: the demonstration's hand rests until all has started
_RESTLESS: Final = 0.5  # share of the hands that follow no room
_CLUTCHES: Final = 0.3  # share of the runs in which the joystick's button is pressed
_DEAF: Final = 0.15  # share of the runs in which a sensor is deaf for a time
_FLICKERS: Final = 0.1  # share of the runs in which an encoder flickers at rest for a time
_SLIPS: Final = 0.1  # share of the runs in which an encoder slips for a time
_CUT_BUMPER: Final = 0.15  # share of the runs in which a bumper's wire is cut for a time, where the robot has one
_CONTROLLER: Final = 0.7  # share of the runs in which a motor controller or its process faults, where the robot has one
_FIRST_FAULT: Final = 3.5  # s: the robot is armed and drives by then
_LAST_FAULT: Final = 1.5  # s before the end

_TRIES: Final = 200
_START_CLEARANCE: Final = 0.9  # m, of the robot's centre
_WAYPOINT_CLEARANCE: Final = 0.75
_BARE: Final = 0.5  # share of the rooms without a threshold
_HALF_THRESHOLD: Final = 2.0  # m


def draw(seed: int, seconds: float = SECONDS) -> Scenario:
    """A room, a hand, faults, and a robot that nobody has calibrated, from the seed."""
    chance = Random(f"{seed}/scenario")
    room = random_room(chance)
    lay_threshold(room, Random(f"{seed}/threshold"))
    hand: Hand = (
        RestlessHand(chance, seconds) if chance.random() < _RESTLESS else DemoHand(room.waypoints, seed, _RESTS_FROM)
    )
    faults = tuple(
        ScheduledFault(
            kind=chance.choices(KINDS, [each.weight for each in KINDS])[0],
            at=chance.uniform(_FIRST_FAULT, seconds - _LAST_FAULT),
            chance=Random(chance.getrandbits(64)),
        )
        for _ in range(chance.randint(*_FAULTS))
    )
    faults += _beside(robot_faults.deaf, _DEAF, Random(f"{seed}/deaf"), seconds)
    faults += _beside(robot_faults.bumper, _CUT_BUMPER, Random(f"{seed}/bumper"), seconds)
    faults += _beside(robot_faults.controller, _CONTROLLER, Random(f"{seed}/controller"), seconds)
    faults += _beside(robot_faults.flicker, _FLICKERS, Random(f"{seed}/flicker"), seconds)
    faults += _beside(robot_faults.slipping_encoder, _SLIPS, Random(f"{seed}/slip"), seconds)
    presses: tuple[tuple[float, float], ...] = ()
    clutch = Random(f"{seed}/clutch")  # a chance of its own: all others stay what they were without it
    if clutch.random() < _CLUTCHES:
        hand = clutching = ClutchingHand(hand, clutch, seconds)
        presses = tuple(clutching.presses)
    return Scenario(seed, room, hand, seconds, faults, draw_truth("uncalibrated", SIM.truth, seed), presses)


def _beside(begin: Begin, share: float, chance: Random, seconds: float) -> tuple[ScheduledFault, ...]:
    """Draw a fault in a share of the runs, by a chance of its own: all others stay what they were without it."""
    if chance.random() >= share:
        return ()
    kind = next(
        each for each in (*KINDS, *robot_faults.OF_BUMPERS, *robot_faults.OF_CONTROLLERS) if each.begin is begin
    )
    return (ScheduledFault(kind, chance.uniform(_FIRST_FAULT, seconds - _LAST_FAULT), Random(chance.getrandbits(64))),)


def random_room(chance: Random) -> Room:
    """Four walls, boxes and posts. Without walls nothing would echo, and the robot would only creep."""
    width, depth = chance.uniform(4.0, 6.5), chance.uniform(3.5, 5.5)
    room = Room("random", Pose(0.0, 0.0, 0.0))
    room.add_wall("walls", [(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)], closed=True)
    for number in range(chance.randint(0, 3)):
        x, y, turn = chance.uniform(0.0, width), chance.uniform(0.0, depth), chance.uniform(0.0, math.pi)
        half_length, half_depth = chance.uniform(0.15, 0.6), chance.uniform(0.1, 0.3)
        cos, sin = math.cos(turn), math.sin(turn)
        corners = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
        points = [
            (x + cos * a * half_length - sin * b * half_depth, y + sin * a * half_length + cos * b * half_depth)
            for a, b in corners
        ]
        room.add_wall(f"box {number}", points, closed=True)
    for number in range(chance.randint(0, 3)):
        room.add_post(
            f"post {number}", chance.uniform(0.0, width), chance.uniform(0.0, depth), chance.uniform(0.04, 0.25)
        )
    start = _free_place(room, chance, width, depth, _START_CLEARANCE)
    room.start = Pose(*start, chance.uniform(-math.pi, math.pi))
    room.waypoints = [_free_place(room, chance, width, depth, _WAYPOINT_CLEARANCE) for _ in range(4)]
    return room


def lay_threshold(room: Room, chance: Random) -> None:
    """In every other room, the edge of a carpet across the middle of where the robot is likely to drive."""
    if chance.random() < _BARE:
        return
    x = sum(place[0] for place in room.waypoints) / len(room.waypoints)
    y = sum(place[1] for place in room.waypoints) / len(room.waypoints)
    along = chance.uniform(-math.pi, math.pi)
    half_x, half_y = _HALF_THRESHOLD * math.cos(along), _HALF_THRESHOLD * math.sin(along)
    room.add_threshold("edge", (x - half_x, y - half_y), (x + half_x, y + half_y))


def _free_place(room: Room, chance: Random, width: float, depth: float, clearance: float) -> tuple[float, float]:
    """A place with that much room around it, m; the freest one found where the room is too full for it."""
    best, best_clearance = (width / 2.0, depth / 2.0), -math.inf
    for _ in range(_TRIES):
        place = chance.uniform(0.0, width), chance.uniform(0.0, depth)
        there = room.clearance(*place)
        if there > best_clearance:
            best, best_clearance = place, there
        if there >= clearance:
            break
    return best
