"""A robot whose left encoder loses half of its counts, judged by the truth of its world."""

import math
from typing import Final

from giraff_core.kinematics.differential_drive import CREEP
from giraff_sim.bodies.wheels.body import LEFT
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.sim.robots import proving_room
from tests.support.wheels import wheels_of

_MOST_TURN: Final = math.radians(35.0)


def test_a_slipping_encoder_hardly_turns_the_robot() -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        loop.simulation.world.room.remove("walls")
        wheels_of(loop.simulation.world).slip_encoder(LEFT, 0.5)
        plant, began = loop.simulation.world.plant, loop.simulation.now_us
        hold(loop, x=FULL_TILT)
        fast_s = fastest = turned = 0.0
        while loop.simulation.now_us - began < 6_000_000:
            before, at_us = plant.pose.yaw, loop.simulation.now_us
            loop.step()
            turned += math.remainder(plant.pose.yaw - before, math.tau)
            if plant.speed > 1.2 * CREEP:
                fast_s += (loop.simulation.now_us - at_us) * 1e-6
                fastest = max(fastest, plant.speed)
        print(
            f"above creep for {fast_s:.2f} s, {fastest:.2f} m/s at most, turned by {math.degrees(turned):.0f} degrees"
        )
        assert 0.0 < fast_s < 1.0
        assert abs(turned) < _MOST_TURN
        assert abs(plant.speed) <= 1.2 * CREEP
        assert "slowed: encoder or motor of the left wheel" in str(loop.newest["base"].reason)
