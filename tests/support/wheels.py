"""The body on two wheels, where a test lays hands on its wheels and wires."""

from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.world.world import World


def wheels_of(world: World) -> WheelsBody:
    """Return the body of a robot on two wheels."""
    assert isinstance(world.body, WheelsBody)
    return world.body
