"""A motion straight through a door: how much room each sense needs beside the robot."""

import math
import random
from typing import Final, NamedTuple

import msgspec

from giraff_core.senses import Sense
from giraff_motion.config import MotionConfig
from giraff_scan.config import ScanConfig
from giraff_scan.service import Scan
from giraff_schemas.motion import MotionMove
from giraff_sim.hosts.cable import Cable
from giraff_sim.truth import draw_truth
from giraff_sim.world.ld19 import Ld19
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import COARSE_STEP_US, SETTINGS
from tests.loop.motions import stage
from tests.loop.rooms import WILD_SHARE
from tests.loop.scanning import LASER
from tests.support.robots import ULTRASONIC
from tests.unit.motion.claims import CALIBRATED, RANGES

_NEAR, _FAR = 1.5, 1.6  # m from the robot to the faces of the wall with the door
_PATIENCE, _LONGEST = 5.0, 45.0  # s for which the way may be blocked, and of a drive


class Kind(NamedTuple):
    """A robot by what it sees with. Its line through the door is off by what its localization leaves."""

    sensors: dict[str, Sense]
    beside: float
    """m, standard deviation. Nothing is off by more than two of them."""
    heading: float
    """rad, the same."""


_BY_WHEELS, _BY_SCAN = (0.05, math.radians(2.0)), (0.02, math.radians(1.0))
KINDS: Final = {
    "ultrasonic": Kind({**ULTRASONIC}, *_BY_WHEELS),
    "scanner": Kind({"laser": LASER}, *_BY_SCAN),
    "both": Kind({"laser": LASER, **ULTRASONIC}, *_BY_SCAN),
    "none": Kind({}, *_BY_WHEELS),
}


class Passage(NamedTuple):
    """Outcome of a drive."""

    outcome: str
    touches: list[float]
    """Speed of each, m/s."""
    seconds: float
    blocked: float
    """s for which the guard let nothing pass."""

    @property
    def is_clean(self) -> bool:
        return self.outcome == "arrived" and not self.touches


def pass_door(name: str, beyond: float, seed: int, distance: float = 3.0) -> Passage:
    """Drive a robot of this kind through a door that leaves `beyond` m at each side of its footprint."""
    kind, chance = KINDS[name], random.Random(f"{seed}/door")
    start = Pose(0.0, _cut(chance, kind.beside), _cut(chance, kind.heading))
    robot = msgspec.structs.replace(SETTINGS.robot, sensors=kind.sensors, calibration=CALIBRATED)
    settings = msgspec.structs.replace(SETTINGS, robot=robot, motion=MotionConfig(patience=_PATIENCE))
    truth = draw_truth("calibrated", RANGES, seed, CALIBRATED)
    with stage(_room(robot.footprint_radius + beyond, start), seed=seed, settings=settings, truth=truth) as it:
        world = it.loop.simulation.world
        for sonar in world.sonars.values():
            sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, WILD_SHARE
        if "laser" in kind.sensors:
            laser = Ld19(LASER, world, f"{seed}/laser", bias=chance.uniform(-0.015, 0.015))
            it.loop.cables["scan"] = Cable(laser, it.loop.simulation)
            it.loop.launch("scan", lambda io: Scan(io, ScanConfig(port="scan"), robot), it.loop.hosts["robot"])
            it.run(0.5)
        it.ask(MotionMove, distance=distance, time_limit=_LONGEST)
        touches, steps, plant = [], 0, world.plant
        while it.state.stage != "ended":
            contacts, speed = plant.contacts, abs(plant.speed)
            it.loop.step()
            touches += [speed] * (plant.contacts > contacts)
            steps += it.state.stage == "moving" and it.loop.newest["guard"].forward.clearance == "blocked"
        state = it.state
        return Passage(state.outcome, touches, state.elapsed, steps * COARSE_STEP_US * 1e-6)


def _room(half: float, start: Pose) -> Room:
    """Two rooms with a door between them, which leaves `half` m at each side of the x axis."""
    room = Room("door", start)
    room.add_wall("walls", [(-1.5, -2.0), (4.0, -2.0), (4.0, 2.0), (-1.5, 2.0)], closed=True)
    for side in (1.0, -1.0):
        edge, end = side * half, side * 2.0
        room.add_wall("jamb", [(_NEAR, end), (_NEAR, edge), (_FAR, edge), (_FAR, end)])
    return room


def _cut(chance: random.Random, deviation: float) -> float:
    while abs(drawn := chance.gauss(0.0, deviation)) > 2.0 * deviation:
        pass
    return drawn
