"""What is asked of the world of a robot that balances, and how it is judged. No board runs here."""

import json
from typing import Any

import pytest

from giraff_schemas.wires.balancer import BalanceDriveFrame
from giraff_sim.bodies.balancer.body import BalancerBody
from giraff_sim.bodies.balancer.judge import BalancerJudge
from giraff_sim.bodies.registry import world_of
from giraff_sim.config import SimConfig
from giraff_sim.control import messages
from giraff_sim.control.control import Control
from giraff_sim.simulation import Simulation, WallPacer
from giraff_sim.world.body import Balance
from giraff_sim.world.hand import StillHand
from giraff_sim.world.world import World
from tests.sim.robots import room_with_wall, world_in
from tests.support.balancer_file import DRIVE, ROBOT

OUTLIVES_US = 350_000


def a_world() -> World:
    return world_of(room_with_wall(2.0), ROBOT, DRIVE, SimConfig(), StillHand(), 1)


def ask(world: World, **request: Any) -> messages.Reply:
    control = Control(Simulation({}, world), {}, WallPacer(), lambda _name, _begin: StillHand())
    return control.answer(json.dumps(request).encode())


def test_it_is_pushed_and_tells_how_it_stood() -> None:
    world = a_world()
    assert isinstance(world.body, BalancerBody)
    assert ask(world, op="push", impulse=5.0).ok
    world.body.raises_it = False
    world.step(None)
    world.step(None)
    assert world.body.plant.loads.force > 0.0
    state = ask(world, op="state").state
    assert state is not None
    assert state.balance is not None
    assert state.balance == Balance(0.0, 0, stands=False, is_settled=True, sits_down_at=10.3)
    assert state.drawn is not None
    assert state.drawn.body_mass == DRIVE.body_mass, "a robot that is exactly as its file says"
    assert not ask(world, op="push", impulse=1.0, height=9.0).ok


def test_a_robot_that_stands_by_itself_is_not_balanced() -> None:
    world = world_in(room_with_wall(2.0))
    assert ask(world, op="push", impulse=5.0).error == "this robot does not balance"
    state = ask(world, op="state").state
    assert state is not None
    assert state.balance is None


def asks(linear: float) -> BalanceDriveFrame:
    return BalanceDriveFrame(
        seq=1, boot_id=1, board_ms=1, linear_um_s=round(linear * 1e6), angular_urad_s=0, ask=0, free_side=0
    )


class Judged:
    """A body that moves as it is told, and its judge."""

    def __init__(self) -> None:
        body = a_world().body
        assert isinstance(body, BalancerBody)
        self.body, self.judge = body, BalancerJudge(body, ROBOT, OUTLIVES_US)
        body.powered_ms = 1000
        self.now_us = 0

    def go(self, seconds: float, speed: float) -> None:
        self.now_us += round(seconds * 1e6)
        self.body.plant.way += speed * seconds
        self.body.plant.speed = speed
        self.judge.note(self.now_us)

    def wrong(self) -> str:
        return self.judge.wrong(self.now_us)


@pytest.mark.parametrize("is_asked_to", [True, False])
def test_it_stops_within_its_bound_however_it_is_stopped(is_asked_to: bool) -> None:
    judged = Judged()
    demand = judged.judge.asked(asks(0.3), 0)
    assert demand is not None
    assert (demand.linear, demand.is_nothing) == (0.3, False)
    judged.go(0.3, 0.3)
    assert judged.judge.goes("forward")
    assert not judged.judge.goes("backward")
    if is_asked_to:
        judged.judge.asked(asks(0.0), judged.now_us)
    else:
        judged.go(0.1, 0.3)
    judged.go(1.0, 0.24)
    assert not judged.wrong(), "0.3² / 0.7 + 0.12 m, and 0.35 s at 0.4 m/s"
    judged.go(1.0, 0.2)
    assert judged.wrong() == "it went 0.44 m after its stop, where 0.39 m is the most"
    judged.body.plant.loads.force = 5.0
    judged.go(0.1, 0.2)
    assert not judged.wrong(), "somebody pushes it"


def test_no_frame_asks_for_more_than_the_robot_may() -> None:
    judged = Judged()
    judged.judge.asked(asks(0.41), 0)
    assert judged.wrong() == "+0.410 m/s, +0.000 rad/s is beyond this robot"
    judged.judge.asked(asks(0.4), 0)
    assert not judged.wrong()
