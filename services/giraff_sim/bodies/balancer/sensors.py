"""Gyroscope and accelerometer of a robot that balances, as volts at the pins of its board.

Both axes of the gyroscope lie in the horizontal plane, at 45 degrees to the axle: each sees the lean, and the roll with
opposite signs. A robot that leans while it turns also rolls.
"""

import math
import random
from collections.abc import Callable
from typing import Final

from giraff_base.drives.balancer.config import GRAVITY
from giraff_sim.bodies.balancer.plant import STEP, Plant

VOLTS_PER_COUNT: Final = 3.3 / 1024
"""V at the pin for each count of the ADC, at its reference of 3.3 V."""
_HALF: Final = 0.5  # count: the converter cuts off, and the zeros are those that a board reads
_GYRO_ZERO: Final = 471.0  # counts
_COUNTS_PER_RAD_S: Final = 1.0 / math.radians(1.611)
_ACCELEROMETER_ZERO: Final = 512.0
_COUNTS_PER_G: Final = 102.0
_DIAGONAL: Final = math.sqrt(0.5)
_FULL: Final = 1024.0
# counts. The noise of the converter and of each sensor. The two conversions of a channel in each ms share one value
# here, so that the mean of a period has the noise of 5 conversions where a real board has that of 10.
_CONVERTER: Final = 0.35
_GYRO_NOISE: Final = math.hypot(_CONVERTER, 0.13)
_ACCELEROMETER_NOISE: Final = math.hypot(_CONVERTER, 0.25)
_GYRO_SMOOTHING: Final = 1.0 - math.exp(-STEP * math.tau * 140.0)
_ACCELEROMETER_SMOOTHING: Final = 1.0 - math.exp(-STEP * math.tau * 50.0)


class Sensors:
    """Reads a plant."""

    def __init__(self, plant: Plant, seed: int) -> None:
        self._plant = plant
        self._noise = random.Random(f"sensors {seed}").gauss
        self.broken: dict[int, Callable[[float], float]] = {}
        """By its channel: what a broken sensor makes of the V that it should give."""
        self._lean_rate = self._roll_rate = self._forward = 0.0
        self._up = 1.0

    def volts(self) -> list[float]:
        """Return V of both axes of the gyroscope, and of the accelerometer forward and up, once each STEP."""
        plant, drawn = self._plant, self._plant.drawn
        noise = self._noise
        sin, cos, height, now = math.sin(plant.lean), math.cos(plant.lean), drawn.sensor_height, plant.seconds
        rate, swings = plant.lean_rate, plant.lean_acceleration
        self._lean_rate += (rate - self._lean_rate) * _GYRO_SMOOTHING
        self._roll_rate += (-plant.turn * sin - self._roll_rate) * _GYRO_SMOOTHING
        across = plant.acceleration + height * (swings * cos - rate * rate * sin)
        along = GRAVITY + plant.acceleration * math.sin(plant.grade) - height * (swings * sin + rate * rate * cos)
        forward, up = (across * cos - along * sin) / GRAVITY, (across * sin + along * cos) / GRAVITY
        zero = drawn.accelerometer_zero + drawn.accelerometer_drift * min(1.0, now / 600.0)
        self._forward += (forward - zero * up - self._forward) * _ACCELEROMETER_SMOOTHING
        self._up += (up + zero * forward - self._up) * _ACCELEROMETER_SMOOTHING
        warm = 1.0 - math.exp(-now / 180.0)
        one = drawn.gyro_gain[0] * _DIAGONAL * (self._lean_rate + self._roll_rate)
        one += drawn.gyro_zero[0] + drawn.gyro_drift[0] * warm
        other = drawn.gyro_gain[1] * _DIAGONAL * (self._lean_rate - self._roll_rate)
        other += drawn.gyro_zero[1] + drawn.gyro_drift[1] * warm
        volts = [
            _at_pin(_GYRO_ZERO + one * _COUNTS_PER_RAD_S + noise(0.0, _GYRO_NOISE)),
            _at_pin(_GYRO_ZERO + other * _COUNTS_PER_RAD_S + noise(0.0, _GYRO_NOISE)),
            _at_pin(_ACCELEROMETER_ZERO + _COUNTS_PER_G * self._forward + noise(0.0, _ACCELEROMETER_NOISE)),
            _at_pin(_ACCELEROMETER_ZERO + _COUNTS_PER_G * self._up + noise(0.0, _ACCELEROMETER_NOISE)),
        ]
        for channel, gives in self.broken.items():
            volts[channel] = gives(volts[channel])
        return volts


def _at_pin(counts: float) -> float:
    return min(_FULL, max(0.0, counts + _HALF)) * VOLTS_PER_COUNT
