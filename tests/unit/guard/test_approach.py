"""A robot that is exactly as slow to react and to brake as the guard reckons never enters the margin."""

import math
from collections.abc import Callable

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from giraff_guard.config import GuardConfig
from giraff_schemas.messages import RobotTime
from tests.support.robots import ULTRASONIC
from tests.unit.guard.senses import CONFIG, EPOCH, FAR, FRONT, ROBOT, Senses

STEP = 0.002  # s
TURN = 0.02  # s between two decisions: a part of the reaction time, since a reading waits for the next one
TICK = 0.02  # s between two ticks of base: a reading's may be that much older than its ping
ACCELERATION = 0.6  # m/s², base's
DECELERATION = 1.5  # m/s²
HALF_CONE = math.radians(7.5)


class Approach:
    """A robot in front of a wall, and the guard between it and a hand that pushes."""

    def __init__(
        self,
        wall: float,
        incidence: float = 0.0,
        period: float = 0.18,
        delay: float = 0.03,
        phase: float = 0.0,
        config: GuardConfig = CONFIG,
    ) -> None:
        self.senses = Senses(config=config)
        self.incidence, self.period, self.delay = incidence, period, delay
        self.wall = wall
        """m to the wall, at right angles to it, from base_link."""
        self.speed = 0.0
        self.closest = math.inf
        self.time = 0.0
        self._config = config
        self._start_ns = self.senses.robot_ns
        self._next_ping = phase
        self._echoes: list[tuple[float, str, float, RobotTime]] = []
        self._levels: list[tuple[float, float]] = []
        self._target = 0.0

    def run(self, seconds: float, asked: Callable[[float], float]) -> None:
        for step in range(round(seconds / STEP)):
            self._sense()
            if step % round(TURN / STEP) == 0:
                self._decide(asked(self.time))
            self._drive()
            self.time += STEP
            self.senses.robot_ns = self._start_ns + round(self.time * 1e9)

    @property
    def clearance(self) -> float:
        return self.wall - ROBOT.footprint_radius

    def _sense(self) -> None:
        if self.time >= self._next_ping:
            self._next_ping += self.period
            since = (self.time % TICK) + TICK
            tick = RobotTime(epoch=EPOCH, robot_ns=self.senses.robot_ns - round(since * 1e9))
            for name in FRONT:
                pose = ULTRASONIC[name]
                away = self.wall - pose.x * math.cos(self.incidence) - pose.y * math.sin(self.incidence)
                distance = away / math.cos(max(0.0, abs(self.incidence) - HALF_CONE))
                self._echoes.append((self.time + self.delay, name, distance, tick))
        while self._echoes and self._echoes[0][0] <= self.time:
            _, name, distance, tick = self._echoes.pop(0)
            self.senses.hear(distance, name, tick=tick)

    def _decide(self, asked: float) -> None:
        self.senses.linear = self.speed
        self.senses.report()
        self._levels.append((self.time + self._config.reaction_time - TURN, self.senses.passes(asked)[0]))

    def _drive(self) -> None:
        while self._levels and self._levels[0][0] <= self.time:
            self._target = self._levels.pop(0)[1]
        if self.speed > self._target:
            self.speed = max(self._target, self.speed - DECELERATION * STEP)
        else:
            self.speed = min(self._target, self.speed + ACCELERATION * STEP)
        self.senses._left += self.speed * STEP
        self.senses._right += self.speed * STEP
        self.wall -= self.speed * STEP * math.cos(self.incidence)
        self.closest = min(self.closest, self.clearance)


@settings(max_examples=15, derandomize=True)
@given(
    wall=st.floats(0.6, 2.5),
    incidence_deg=st.floats(-25.0, 25.0),
    period=st.sampled_from([0.18, 0.18, 0.27, 0.36]),
    delay=st.floats(0.005, 0.04),
    phase=st.floats(0.0, 0.18),
    asked=st.lists(st.sampled_from([0.0, 0.1, 0.3, 0.6, 0.6]), min_size=10, max_size=10),
)
def test_no_approach_enters_the_margin(
    wall: float, incidence_deg: float, period: float, delay: float, phase: float, asked: list[float]
) -> None:
    approach = Approach(wall, math.radians(incidence_deg), period, delay, phase)
    approach.run(5.0, lambda t: asked[int(t * 2) % 10])
    assert approach.closest >= min(CONFIG.margin, wall - ROBOT.footprint_radius)


@settings(max_examples=15, derandomize=True)
@given(wall=st.floats(0.7, 2.0), period=st.floats(0.06, 0.36), phase=st.floats(0.0, 0.18))
def test_not_even_where_the_geometry_leaves_no_slack(wall: float, period: float, phase: float) -> None:
    """Head on, with a guard that counts on nothing but head on: only the timing keeps the margin."""
    head_on = msgspec.structs.replace(CONFIG, incidence=0.001, half_cone=0.001)
    approach = Approach(wall, 0.0, period, 0.03, phase, config=head_on)
    approach.run(5.0, lambda _: 0.6)
    assert approach.closest >= CONFIG.margin


@pytest.mark.parametrize(("wall", "incidence_deg"), [(0.8, -25), (0.8, 12), (1.5, -7), (1.5, 25), (2.5, 0), (2.5, 25)])
def test_a_hand_that_pushes_gets_near_and_can_always_leave(wall: float, incidence_deg: float) -> None:
    approach = Approach(wall, math.radians(incidence_deg))
    approach.run(10.0, lambda _: 0.6)
    assert approach.speed == 0.0
    assert CONFIG.margin <= approach.clearance <= CONFIG.margin + 0.12
    approach.senses.hear(FAR, "rear")
    approach.senses.hear(FAR, "rear")
    assert approach.senses.passes(0.0, 1.5) == (0.0, 1.5)
    linear, angular = approach.senses.passes(-0.6, 0.2)
    assert linear <= -0.1
    assert angular / linear == pytest.approx(0.2 / -0.6)


def test_a_wall_that_comes_from_nowhere_stops_the_robot_as_fast_as_it_can() -> None:
    """It is seen too near to stop before the margin; what is left is the stopping distance."""
    approach = Approach(5.0)
    approach.run(3.0, lambda _: 0.6)
    assert approach.speed == 0.6
    approach.wall = 0.3 + 0.35
    approach.run(3.0, lambda _: 0.6)
    assert approach.speed == 0.0
    slot = approach.period + approach.delay
    assert approach.clearance >= 0.35 - 0.6 * (slot + CONFIG.reaction_time) - 0.6**2 / 3.0
    assert approach.senses.passes(0.0, 1.0) == (0.0, 1.0)
