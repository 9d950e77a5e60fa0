"""The whole robot in simulated time, for the tests here."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import msgspec

from giraff_core.senses import Camera
from giraff_joystick.config import JoystickConfig
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.hosts.process import Observer
from giraff_sim.settings import Services, Settings
from giraff_sim.simulation import simulation
from giraff_sim.truth import Truth, draw_truth
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Room
from tests.sim.robots import EXACT
from tests.support.robots import BASE, BY_SPEED, ROBOT

BY_LEVELS = Settings(robot=ROBOT, base=BASE)
SETTINGS = Settings(robot=ROBOT, base=msgspec.structs.replace(BASE, drive=BY_SPEED))
SEES = msgspec.structs.replace(
    SETTINGS, robot=msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"head": Camera(x=0.05, z=1.0, pitch=0.35)})
)
"""With a camera."""
SOURCE_CURVE = msgspec.structs.replace(BY_LEVELS, joystick=JoystickConfig(port="joystick", curve="source"))
COARSE_STEP_US: Final = 4000
"""As in tests/dst. A step of 1 ms takes half as long again, and only shows what comes within milliseconds."""
GRAVITY = 9.81
FULL_TILT = 7.5
"""m/s² along one axis: more than the default curve's full speed needs."""
_SAYS_ANEW: Final = 0.5
"""s after which what base has told last is of now, even if it was started just now."""


class SeenRobot:
    """A robot in simulated time, and what tests ask of it most."""

    def __init__(self, loop: ClosedLoop) -> None:
        self.loop = loop

    @property
    def now(self) -> float:
        """Simulated s."""
        return self.loop.simulation.now_us * 1e-6

    @property
    def driver(self) -> str:
        """Who holds the lease."""
        return str(self.loop.newest["lease"].operator)

    @property
    def armed(self) -> bool:
        return bool(self.loop.newest["base"].armed)

    def run(self, seconds: float) -> None:
        self.loop.run(seconds)


def drawn(seed: int) -> Truth:
    """A robot that nobody has calibrated."""
    return draw_truth("uncalibrated", SimConfig().truth, seed)


@contextmanager
def closed_loop(
    room: Room,
    settings: Settings = SETTINGS,
    implementation: Implementation = Implementation.HOST,
    sim: SimConfig = EXACT,
    seed: int = 1,
    services: Services | None = None,
    truth: Truth | None = None,
    step_us: int = COARSE_STEP_US,
    *,
    observer: Observer | None = None,
) -> Iterator[ClosedLoop]:
    """A robot that is exactly as its file says, unless another `truth` is given."""
    world = world_of(room, settings.robot, settings.base.drive, sim, StillHand(), seed, step_us, truth=truth or Truth())
    with simulation(world, implementation=implementation, ranger=settings.ranger.board_type) as running:
        yield ClosedLoop(running, settings, services, observer=observer)


def spare_time(loop: ClosedLoop) -> None:
    """End odometry, which moves nothing, and takes a seventh of the time."""
    loop.kill("odometry")


def hold(loop: ClosedLoop, x: float = 0.0, y: float = 0.0) -> None:
    """Hold the joystick so that it feels this along its axes, m/s²."""
    loop.simulation.world.hand = StillHand((x, y, GRAVITY))


def arm(loop: ClosedLoop) -> None:
    """Hold the hand level until the robot says anew that it is armed, for 2 s at most."""
    hold(loop)
    loop.run(_SAYS_ANEW)
    until_us = loop.simulation.now_us + round((2.0 - _SAYS_ANEW) * 1e6)
    while not _is_armed(loop) and loop.simulation.now_us < until_us:
        loop.step()
    assert _is_armed(loop), loop.newest["base"].reason


def _is_armed(loop: ClosedLoop) -> bool:
    return "base" in loop.newest and loop.newest["base"].armed
