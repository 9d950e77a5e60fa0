"""What happens to the joystick while the robot drives, in simulated time: from the mishap to PWM zero, and after it."""

from collections.abc import Callable

import pytest

from giraff_joystick.hand_detector import DETECTION_S, FALLING, FROZEN, LAID_DOWN, SHAKEN
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.hand import Dropped, LaidDown, Shaken, StillHand
from tests.loop.loops import FULL_TILT, arm, closed_loop, drawn, hold, spare_time
from tests.sim.robots import room_with_wall

NOISY = SimConfig()
CHAIN = 0.15
"""s that a fault takes from the reading to the motors: joystick, guard and base at their rates."""
PUT_DOWN = 0.06
"""s by which the last readings of the hand and of its letting go still count as motion."""


def drops(loop: ClosedLoop) -> None:
    loop.simulation.world.hand = Dropped(loop.simulation.now_us * 1e-6)


def shakes(loop: ClosedLoop) -> None:
    loop.simulation.world.hand = Shaken(loop.simulation.now_us * 1e-6)


def lays_down(loop: ClosedLoop) -> None:
    loop.simulation.world.hand = LaidDown()


def freezes(loop: ClosedLoop) -> None:
    assert loop.simulation.bno055 is not None
    loop.simulation.bno055.fault = Bno055Fault.FROZEN


def dies(loop: ClosedLoop) -> None:
    assert loop.simulation.bno055 is not None
    loop.simulation.bno055.fault = Bno055Fault.DEAD


MISHAPS: dict[str, tuple[Callable[[ClosedLoop], None], float]] = {
    "dropped": (drops, DETECTION_S[FALLING] + CHAIN),
    "shaken": (shakes, DETECTION_S[SHAKEN] + CHAIN),
    "frozen": (freezes, DETECTION_S[FROZEN] + CHAIN),
    "dead": (dies, 0.06 + CHAIN),
    "laid down": (lays_down, DETECTION_S[LAID_DOWN] + PUT_DOWN + CHAIN),
}
LATEST_MS = {"dropped": 16, "shaken": 16, "frozen": 4, "dead": 0, "laid down": 16}
"""Moment in the board's cycle at which each of them stops the robot latest."""


def driving(loop: ClosedLoop, delay_ms: int) -> None:
    spare_time(loop)
    arm(loop)
    hold(loop, x=FULL_TILT)
    loop.run(1.5 + delay_ms * 1e-3)
    assert loop.newest["wheels"].left_velocity == pytest.approx(0.6, rel=0.02)


def require_stop(mishap: str, delay_ms: int) -> None:
    """Fail where a mishap stops the robot too late, or what comes after it moves the robot too soon.

    `delay_ms`: moment in the board's cycle of 20 ms.
    """
    happens, bound = MISHAPS[mishap]
    with closed_loop(room_with_wall(4.0), sim=NOISY, seed=delay_ms, truth=drawn(delay_ms)) as loop:
        driving(loop, delay_ms)
        happens(loop)
        began_us = loop.simulation.now_us
        loop.run(bound + 0.5)
        last = loop.simulation.record.window(began_us, loop.simulation.now_us).last_driven_us
        assert last is not None
        assert not loop.newest["base"].armed
        stops = (last - began_us) * 1e-6
        print(f"{mishap}: PWM zero after {stops:.3f} s")
        assert stops <= bound
        assert mishap == "laid down" or stops <= 0.45
        if mishap in {"frozen", "dead"}:
            return
        again_us = loop.simulation.now_us
        # Tilted, level for less than arming takes, and tilted to ask for the lease that a long fault has ended.
        for tilt, seconds in ((FULL_TILT, 2.0), (0.0, 0.1), (FULL_TILT, 1.0)):
            hold(loop, x=tilt)
            loop.run(seconds)
        assert loop.simulation.record.window(again_us, loop.simulation.now_us).driven_ms == 0
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(0.5)
        assert loop.newest["wheels"].left_pwm_counts > 0


@pytest.mark.parametrize("mishap", MISHAPS)
def test_a_mishap_stops_the_robot_within_its_bound(mishap: str) -> None:
    """And only a level hand arms it again."""
    require_stop(mishap, LATEST_MS[mishap])


def test_a_hand_that_holds_still_drives_on() -> None:
    hold_still(3.0)


def hold_still(seconds: float) -> None:
    """Turn in place for so long, so that nothing but the hand can end it."""
    with closed_loop(room_with_wall(4.0), sim=NOISY, truth=drawn(1)) as loop:
        spare_time(loop)
        arm(loop)
        hold(loop, y=FULL_TILT)
        loop.run(1.0)
        for _ in range(round(seconds * 10.0)):
            loop.run(0.1)
            assert loop.newest["cmd_vel/joystick"].source == "hand"


def test_the_clutch_stops_and_its_attitude_is_the_new_level() -> None:
    with closed_loop(room_with_wall(4.0), sim=NOISY, truth=drawn(1)) as loop:
        driving(loop, 0)
        loop.simulation.world.hand = StillHand((6.0, 0.0, 7.75))  # 38 degrees
        loop.run(0.3)
        loop.simulation.world.button = True
        pressed_us = loop.simulation.now_us
        loop.run(1.0)
        last = loop.simulation.record.window(pressed_us, loop.simulation.now_us).last_driven_us
        assert last is not None
        assert (last - pressed_us) * 1e-6 <= CHAIN
        loop.simulation.world.button = False
        released_us = loop.simulation.now_us
        loop.run(1.0)
        assert loop.simulation.record.window(released_us, loop.simulation.now_us).driven_ms == 0
        assert loop.newest["base"].armed
        hold(loop)  # flat is 38 degrees backward of it
        loop.run(0.5)
        assert loop.newest["wheels"].left_pwm_counts < 0
