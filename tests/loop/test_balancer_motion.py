"""A motion of a robot that balances through all of it, in simulated time. It sways while it stands."""

import math
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_schemas.motion import MotionGo, Move, Turn
from giraff_sim.truth import draw_truth
from giraff_sim.world.world import STEP_US
from tests.loop.motions import stage
from tests.support.balancer_file import BALANCER, SIM

END: Final = Pose(0.4, -0.2, math.pi / 2.0)


def test_it_arrives_by_odometry_and_in_truth() -> None:
    truth = draw_truth("calibrated", SIM.truth, 1)
    with stage(settings=BALANCER, truth=truth, step_us=STEP_US) as it:
        plant = it.loop.simulation.world.plant
        it.ask(MotionGo, steps=(Move(distance=0.4), Turn(angle=math.pi / 2.0), Move(distance=-0.2)))
        it.until_ended(20.0)
        state = it.state
        it.run(0.5)  # what it does once its motion has ended
        assert state.outcome == "arrived", state
        for pose in (state.achieved, plant.pose):
            assert math.dist((pose.x, pose.y), END[:2]) < 0.10
            assert abs(pose.yaw - END.yaw) < math.radians(6.0)
        assert plant.contacts == 0
