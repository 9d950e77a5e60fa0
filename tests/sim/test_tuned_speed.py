"""Gains that `giraff tune speed` finds, on robots whose robot file has others. The true wheels judge them."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, NamedTuple

import msgspec
import pytest

from giraff_base.drives.wheels.config import SpeedControl
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.wire import BoardKind, WheelsFrame
from giraff_setup.wheels.speed.fit import DISTANCE, SPEED, Leg, follow, legs_of, measure
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.config import SimConfig
from giraff_sim.simulation import simulation
from giraff_sim.truth import TruthRanges, draw_truth
from giraff_sim.world.hand import StillHand
from tests.sim.line import BaseLine
from tests.sim.robots import empty_room
from tests.support.robots import BY_SPEED, ROBOT
from tests.support.wheels import wheels_of

TURN: Final = 0.02  # s
RAMP: Final = 0.6 * TURN
"""m/s by which base speeds up in a turn."""
BRAKING: Final = 0.4  # m/s², of giraff_motion
NEAR: Final = 0.004
"""m from the end, where it stops."""
REST: Final = 0.15  # s


class Robot(NamedTuple):
    """A drawn robot, and how far its file is off."""

    motor_time: float
    """s. True time constant."""
    times: float
    """Factor on all gains."""
    filed_time: float
    """s. Time constant in the robot file."""
    is_kept: bool = False
    """It follows as well as a drive can tell."""
    is_better: bool = True
    """It follows better by the gains that are found, in all that is judged."""


ROBOTS: Final = (
    Robot(0.27, 0.3, 0.45),
    Robot(0.08, 3.0, 0.3, is_kept=True),
    Robot(0.36, 1.0, 0.45, is_kept=True),
    Robot(0.36, 2.5, 0.2, is_better=False),
)


class Follow(NamedTuple):
    """What the true wheels did, as shares of the asked speed."""

    overshoot: float
    error: float
    """The largest one in the second half of the way, up to the braking."""

    @property
    def is_good(self) -> bool:
        """Return whether a tuned robot may do it."""
        return self.overshoot <= 0.1 and self.error <= 0.03


class Drive(BaseLine):
    """The board of one robot, driven as base and motion drive it."""

    def legs(self, *ways: int) -> Follow:
        """Drive each way from rest to rest: 1 is ahead, -1 back."""
        plant = wheels_of(self.simulation.world).plant
        fastest = error = 0.0
        for way in ways:
            began, asked = plant.left.travel, 0.0
            while (left := DISTANCE - abs(plant.left.travel - began)) > NEAR:
                asked = min(asked + RAMP, SPEED, math.sqrt(2.0 * BRAKING * left))
                self.go(way * asked, way * asked, TURN)
                speeds = abs(plant.left.speed), abs(plant.right.speed)
                fastest = max(fastest, *speeds)
                if asked == SPEED and left < DISTANCE / 2.0:
                    error = max(error, *(abs(speed / SPEED - 1.0) for speed in speeds))
            self.go(0.0, 0.0, REST)
        return Follow(max(0.0, fastest / SPEED - 1.0), error)

    def heard(self) -> list[Leg]:
        """Return what the command makes of the telemetry, as base publishes it."""
        wheels = [
            Wheels(
                instance="base",
                left_ticks=frame.left_ticks,
                right_ticks=frame.right_ticks,
                left_velocity=frame.left_um_s * 1e-6,
                right_velocity=frame.right_um_s * 1e-6,
                left_pwm_counts=frame.left_pwm_counts,
                right_pwm_counts=frame.right_pwm_counts,
                board_us=frame.board_us,
                boot_id=frame.boot_id,
                tick=RobotTime(1, 1),
            )
            for frame in self.all(WheelsFrame)
        ]
        return legs_of(wheels, (ROBOT.ticks_per_metre, ROBOT.ticks_per_metre))


@contextmanager
def driven(seed: int, control: SpeedControl) -> Iterator[Drive]:
    """Start the robot of a seed with these settings."""
    drive = msgspec.structs.replace(BY_SPEED, speed_control=control)
    sim = SimConfig(tilt_noise=0.0, motor_time_constant=ROBOTS[seed].motor_time)
    truth = draw_truth("calibrated", TruthRanges(), seed)
    world = world_of(empty_room(), ROBOT, drive, sim, StillHand(), 1, truth=truth)
    with simulation(world, (BoardKind.BASE,), Implementation.HOST) as running:
        line = Drive(running)
        line.boot()
        line.begin_session(drive.board_settings(ROBOT, 1.2))
        line.go(0.0, 0.0, 0.04)
        yield line


def spoiled(robot: Robot) -> SpeedControl:
    usual = SpeedControl()
    gains = {name: getattr(usual, name) * robot.times for name in ("speed_p", "speed_i", "turn_p", "turn_i")}
    return msgspec.structs.replace(usual, **gains, motor_time=robot.filed_time)


@pytest.mark.parametrize("seed", range(len(ROBOTS)))
def test_gains_are_changed_only_for_a_better_drive(seed: int) -> None:
    robot = ROBOTS[seed]
    with driven(seed, spoiled(robot)) as line:
        before, as_filed = line.legs(1, -1), line.heard()
    _, proposal = measure(as_filed, spoiled(robot))
    off = proposal.control.motor_time / robot.motor_time - 1.0
    assert abs(off) <= min(proposal.bound["motor_time"], 0.1), "no more than it tells, and little"
    assert proposal.changes(spoiled(robot))
    assert follow(as_filed).is_good == robot.is_kept
    if robot.is_kept:
        assert before.is_good
        return
    with driven(seed, proposal.control) as line:
        after, as_found = line.legs(1, -1), line.heard()
    assert follow(as_found).beats(follow(as_filed)) == robot.is_better
    assert (after.error <= before.error + 0.001) == robot.is_better
    assert not follow(as_filed).beats(follow(as_found))
    assert after.is_good
