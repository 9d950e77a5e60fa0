"""A service that ends while the robot drives, in simulated time: the bare bounds, and what a restart may do.

What a restart of base and guard may do is in tests/dst/test_doubles.py.
"""

import pytest

from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.sim.robots import proving_room

BOUNDS = {"base": 0.35, "guard": 0.35, "joystick": 0.45, "ranger": 0.45}
"""s from the end of the service to PWM zero."""

LATEST_MS = 120
"""Moment in the cycle of the ranger, which takes 180 ms, at which its end stops the robot latest."""
DRIVES = 0.92
"""s for which the robot has driven when the service ends."""


def zero_after_kill(service: str, delay_ms: int) -> float:
    """Return the s from the end of the service, `delay_ms` later than after `DRIVES`, to PWM zero."""
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(DRIVES + delay_ms * 1e-3)
        loop.kill(service)
        killed_us = loop.simulation.now_us
        loop.run(1.0)
        last = loop.simulation.record.window(killed_us, loop.simulation.now_us).last_driven_us
        assert last is not None, "the robot did not drive when the service ended"
        return (last - killed_us) * 1e-6


@pytest.mark.parametrize("service", BOUNDS)
def test_pwm_is_zero_within_the_bound(service: str) -> None:
    assert zero_after_kill(service, LATEST_MS) <= BOUNDS[service]


@pytest.mark.parametrize("service", ["joystick", "ranger"])
def test_a_restarted_service_moves_nothing_before_a_neutral_hand(service: str) -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(1.0)
        loop.kill(service)
        loop.run(1.5)
        loop.start(service)
        restarted_us = loop.simulation.now_us
        loop.run(2.0)
        assert loop.simulation.record.window(restarted_us, loop.simulation.now_us).driven_ms == 0
        assert loop.newest["base"].reason
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(1.0)
        assert loop.newest["wheels"].left_pwm_counts > 0


def test_without_odometry_driving_goes_on() -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(1.0)
        loop.kill("odometry")
        loop.run(1.0)
        assert loop.newest["wheels"].left_pwm_counts == 70


@pytest.mark.parametrize("service", ["base", "guard", "joystick"])
def test_a_saved_limit_whose_name_nobody_knows_keeps_the_robot_from_moving(service: str) -> None:
    """Somebody may have tightened what has another name since then."""
    with closed_loop(proving_room()) as loop:
        host = loop.processes[service].host
        host.disk.files[f"params/{service}.json"] = b'{"its_former_name": 0.1}'
        loop.kill(service)
        loop.start(service)
        loop.run(1.6)
        hold(loop, x=FULL_TILT)
        loop.run(0.3)
        assert loop.simulation.record.window(0, loop.simulation.now_us).driven_ms == 0
        assert "its_former_name" in str(loop.newest["base"].reason)
