"""What happens to the robot of a seed."""

from __future__ import annotations

from random import Random
from typing import Final

from giraff_sim.dst.faults import machine as machine_faults
from giraff_sim.dst.faults import network as network_faults
from giraff_sim.dst.faults import robot as robot_faults
from giraff_sim.dst.hands import ClutchingHand, RestlessHand
from giraff_sim.dst.rooms import lay_threshold, random_room
from giraff_sim.dst.simulated_run import SECONDS, SIM, Begin, Kind, Scenario, ScheduledFault
from giraff_sim.truth import draw_truth
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.hand import Hand

KINDS: Final[tuple[Kind, ...]] = (*network_faults.KINDS, *machine_faults.KINDS, *robot_faults.KINDS)

_FAULTS: Final = (1, 5)
_RESTS_FROM: Final = 0.9  # s: the demonstration's hand rests until all has started
_RESTLESS: Final = 0.5  # share of the hands that follow no room
_CLUTCHES: Final = 0.3  # share of the runs in which the joystick's button is pressed
_DEAF: Final = 0.15  # share of the runs in which a sensor is deaf for a time
_FLICKERS: Final = 0.1  # share of the runs in which an encoder flickers at rest for a time
_SLIPS: Final = 0.1  # share of the runs in which an encoder slips for a time
_CUT_BUMPER: Final = 0.15  # share of the runs in which a bumper's wire is cut for a time, where the robot has one
_FIRST_FAULT: Final = 3.5  # s: the robot is armed and drives by then
_LAST_FAULT: Final = 1.5  # s before the end


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
    kind = next(each for each in (*KINDS, *robot_faults.OF_BUMPERS) if each.begin is begin)
    return (ScheduledFault(kind, chance.uniform(_FIRST_FAULT, seconds - _LAST_FAULT), Random(chance.getrandbits(64))),)
