"""Odometry against the world's truth over a long mixed path, in simulated time, with true geometry."""

from __future__ import annotations

import math

import msgspec

from giraff_schemas.wire import BoardKind, ResetCause
from tests.loop.loops import FULL_TILT, SETTINGS, arm, closed_loop, hold
from tests.sim.robots import EXACT, proving_room

LEGS = (
    (2.6, 0.0, 9.0),  # tilt x, tilt y (m/s²), s
    (0.0, 2.4, 3.0),
    (3.6, 0.8, 8.0),
    (-2.8, 0.0, 6.0),
    (4.2, -1.9, 14.0),
    (0.0, -3.0, 4.0),
    (5.0, 1.7, 16.0),
    (-3.2, 1.8, 9.0),
    (6.0, 0.0, 20.0),
    (4.0, 2.2, 12.0),
)
"""Straight, turning in place, curves of both hands, forward and backward."""

LENGTH = 30.0  # m

TRUSTING = msgspec.structs.replace(SETTINGS, guard=msgspec.structs.replace(SETTINGS.guard, proof_travel=1000.0))
"""Once its sensors have heard the walls, the guard lets the robot drive in the open for as far as it goes."""


def test_thirty_metres_are_within_one_percent() -> None:
    with closed_loop(proving_room(), TRUSTING, sim=EXACT) as loop:
        arm(loop)
        loop.simulation.world.room.remove("walls")
        plant = loop.simulation.world.plant
        start = loop.newest["odom"]
        assert (start.x, start.y, start.yaw) == (0.0, 0.0, 0.0)
        while plant.path_length < LENGTH:
            for x, y, seconds in LEGS:
                hold(loop, x, y)
                loop.run(seconds)
        hold(loop)
        loop.run(1.5)
        odom, truth = loop.newest["odom"], plant.pose
        error = math.hypot(odom.x - truth.x, odom.y - truth.y)
        yaw_error = abs(math.remainder(odom.yaw - truth.yaw, math.tau))
        print(
            f"path {plant.path_length:.2f} m: position off by {error * 1000:.1f} mm "
            f"({error / plant.path_length:.3%}), yaw by {math.degrees(yaw_error):.2f} deg"
        )
        assert error <= 0.01 * plant.path_length
        assert math.isclose(odom.path, plant.path_length, rel_tol=0.01)


def test_a_reset_board_is_a_new_boot_and_no_jump() -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(3.0)
        before, boot_id = loop.newest["odom"], loop.newest["wheels"].boot_id
        loop.simulation.reset(BoardKind.BASE, ResetCause.EXTERNAL)
        farthest = before
        for _ in range(2000):
            loop.step()
            odom = loop.newest["odom"]
            step = math.hypot(odom.x - farthest.x, odom.y - farthest.y)
            assert step < 0.02, f"odometry jumped by {step:.3f} m"
            farthest = odom
        assert loop.newest["wheels"].boot_id == boot_id + 1
        truth = loop.simulation.world.plant.pose
        assert math.hypot(farthest.x - truth.x, farthest.y - truth.y) < 0.3, "more was lost than the reset itself"
