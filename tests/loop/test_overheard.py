"""A robot whose front sensors are deaf, and take another robot's pings for their own echoes."""

from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold, spare_time


def test_a_deaf_robot_beside_another_one_touches_slowly() -> None:
    room = Room("a wall", Pose(0.0, 0.0, 0.0))
    room.add_wall("wall", [(3.0, -6.0), (3.0, 6.0)])
    with closed_loop(room) as loop:
        spare_time(loop)
        arm(loop)
        world, began = loop.simulation.world, loop.simulation.now_us
        for sonar in (world.sonars[0], world.sonars[1]):
            sonar.fault, sonar.overheard, sonar.overheard_step = SonarFault.OVERHEARS, 3.0, 0.004
        hold(loop, x=FULL_TILT)
        fastest = speed = 0.0
        while not world.plant.contacts:
            fastest, speed = max(fastest, speed), world.plant.speed
            loop.step()
            assert loop.simulation.now_us - began < 12_000_000
        assert fastest > 0.5  # trusted at first
        assert speed < 0.16
