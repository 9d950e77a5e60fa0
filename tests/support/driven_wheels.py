"""Two wheels that a model of their motors turns, and a drive of them as base publishes it."""

import math
from collections.abc import Iterator
from typing import Final

from giraff_schemas.messages import RobotTime, Wheels
from giraff_setup.wheels.speed.fit import Motor

TICKS: Final = 2002.0594
STEP: Final = 0.01  # s
MOTORS: Final = (Motor(per_count=0.0085, time=0.2, dead=2.0), Motor(per_count=0.0075, time=0.2, dead=1.0))


class Turning:
    """One wheel whose motor follows the model, under a slow loop. It is sampled between two changes of its PWM."""

    def __init__(self, motor: Motor) -> None:
        self.motor, self.speed, self.travel, self.pwm = motor, 0.0, 0.0, 0

    def step(self, asked: float, push: int = 0, gain: float = 60.0) -> None:
        self._move()
        self.pwm = push or round(asked / 0.0086 + gain * (asked - self.speed)) if asked else 0
        self._move()

    def _move(self) -> None:
        k, time, dead = self.motor
        aim = k * (self.pwm - math.copysign(dead, self.pwm)) if self.pwm else 0.0
        self.speed += (aim - self.speed) / time * STEP / 2.0
        self.travel += self.speed * STEP / 2.0


def drive(*, pace: float = 0.25, ticks: float = TICKS, push: int = 0, gain: float = 60.0) -> Iterator[Wheels]:
    """Yield the wheels of a way ahead and back, a sample each STEP.

    `push`: PWM counts all along, without the loop. `gain`: PWM counts for each m/s that is lacking.
    """
    sides, asked, at = [Turning(motor) for motor in MOTORS], 0.0, 0
    for way in (1.0, -1.0):
        began = sides[0].travel
        for step in range(300):
            left = max(0.0, 0.5 - way * (sides[0].travel - began))
            asked = min(asked + 0.006, pace, math.sqrt(0.8 * left)) if left > 0.004 and step < 250 else 0.0
            for side in sides:
                side.step(way * asked, round(way * push), gain)
            at += 1
            yield sample(at, *sides, ticks=ticks)


def sample(at: int, left: Turning, right: Turning, *, ticks: float = TICKS) -> Wheels:
    return Wheels(
        instance="base",
        left_ticks=math.floor(left.travel * ticks),
        right_ticks=math.floor(right.travel * ticks),
        left_velocity=left.speed,
        right_velocity=right.speed,
        left_pwm_counts=left.pwm,
        right_pwm_counts=right.pwm,
        board_us=(at * 10_000 - 2_000_000) % (1 << 32),
        boot_id=1,
        tick=RobotTime(1, (1000 + at) * 10_000_000),
    )
