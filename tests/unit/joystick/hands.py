"""What the sensor reads in hands, out of them and in a crash, as the board sends it: counts, 50 times a second."""

import math
import random
from collections.abc import Callable, Iterator

from giraff_joystick.hand_detector import Counts
from giraff_sim.world.bno055 import GRAVITY, Vector
from giraff_sim.world.hand import Tremor

PERIOD = 0.02
NOISE = 0.012
"""m/s², rms of each axis: the BNO055's, by its datasheet."""
MODAL_TREMOR = 0.04
"""m/s², rms of each axis: 0.07 of the vector, which is 0.1 peak, the most frequent among people."""


def tilted(forward_deg: float) -> Vector:
    return GRAVITY * math.sin(math.radians(forward_deg)), 0.0, GRAVITY * math.cos(math.radians(forward_deg))


def counts(vector: Vector) -> Counts:
    x, y, z = (round(value * 100) for value in vector)
    return x, y, z


def readings(
    feel: Callable[[float], Vector], seconds: float, *, noise: float = NOISE, tremor: float = 0.0, seed: int = 1
) -> Iterator[Counts]:
    """What is read of `feel(seconds)`."""
    chance, shaking = random.Random(seed), Tremor(tremor, seed)
    for step in range(round(seconds / PERIOD)):
        now = step * PERIOD
        x, y, z = shaking.added_to(feel(now), now)
        yield counts((x + chance.gauss(0, noise), y + chance.gauss(0, noise), z + chance.gauss(0, noise)))
