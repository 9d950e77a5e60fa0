"""Thin posts between and beside the cones, and somebody who pushes on: how many are touched, and how fast."""

import random
from collections.abc import Iterator

import pytest

from giraff_sim.config import SimConfig
from tests.loop.loops import arm, closed_loop, drawn, hold
from tests.sim.robots import empty_room
from tests.support.report import report

DRIVES = 300
LEG = 20
PUSHES_S = 25.0
_STEP_US = 4000
_FAST = 0.2  # m/s


def touch(seed: int) -> float | None:
    """m/s at the first touch of a drive straight ahead at a post; None: it touches nothing."""
    choose = random.Random(f"{seed}/post")
    room = empty_room()
    room.add_post("post", choose.uniform(1.2, 3.0), choose.uniform(-0.4, 0.4), choose.uniform(0.02, 0.15))
    room.add_wall("wall", [(4.1, -4.0), (4.1, 4.0)])
    with closed_loop(room, sim=SimConfig(), seed=seed, truth=drawn(seed), step_us=_STEP_US) as loop:
        plant = loop.simulation.world.plant
        arm(loop)
        hold(loop, x=choose.uniform(4.0, 7.5))
        end = loop.simulation.now_us + round(PUSHES_S * 1e6)
        speed = 0.0
        while not plant.contacts:
            if loop.simulation.now_us >= end:
                return None
            speed = plant.speed
            loop.step()
        return speed


@pytest.fixture(scope="module")
def speeds() -> Iterator[list[float | None]]:
    """What `touch` says of all drives that were made; few may be fast."""
    made: list[float | None] = []
    yield made
    touches = [speed for speed in made if speed is not None]
    fast = sum(speed > _FAST for speed in touches)
    figures = {
        "drives": len(made),
        "touches": len(touches),
        "faster_than_0.2_m_s": fast,
        "fastest_m_s": round(max(touches, default=0.0), 2),
    }
    report("campaign/posts", figures)
    if len(made) == DRIVES:  # a share of few says nothing
        assert fast <= DRIVES // 10


@pytest.mark.parametrize("first", range(0, DRIVES, LEG))
def test_posts(first: int, speeds: list[float | None]) -> None:
    speeds += [touch(seed) for seed in range(first, first + LEG)]
