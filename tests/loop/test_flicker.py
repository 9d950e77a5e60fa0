"""A motion of a robot whose encoders count to and fro while its wheels rest, in simulated time."""

import pytest

from giraff_schemas.motion import MotionMove
from tests.loop.motions import stage
from tests.support.wheels import wheels_of


def test_a_motion_arrives_although_both_encoders_flicker_at_rest() -> None:
    with stage() as it:
        world = it.loop.simulation.world
        for wheel in range(2):
            wheels_of(world).flicker_encoder(wheel, flickers=True)
        began = it.now
        it.run(1.0)
        assert it.driven_ms(began) == 0
        it.begin(MotionMove, distance=0.2)
        it.until_ended(4.0)
        assert (it.state.outcome, str(it.state.reason)) == ("arrived", "")
        assert world.plant.pose.x == pytest.approx(0.2, abs=0.005)
        ended = it.now
        it.run(1.0)
        assert it.driven_ms(ended) == 0
