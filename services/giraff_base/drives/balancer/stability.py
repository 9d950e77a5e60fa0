"""Whether gains hold a robot that balances: the sampled loop of its physics, and Jury's test of it.

The state is lean, its rate, place and speed; what acts is the torque of both motors. Neither gear play nor friction is
part of the model: the board compensates them. Plain Python: base has no numpy.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Final, NamedTuple

from giraff_schemas.wires.balancer import BALANCE_PERIOD_MS

Rows = list[list[float]]
"""A matrix."""

PERIOD: Final = BALANCE_PERIOD_MS / 1000
"""s between two commands of the board."""
DELAYS: Final = (1, 2, 3)
"""Periods between a reading and the torque that answers it: sensors, computing and the line to the driver."""
MARGIN: Final = (1 / 4, 1.0, 3.5)
"""All gains together, times each of these, must hold the robot. With less margin drawn robots fell, or wandered far."""
_LEAN_MARGIN: Final = (1 / 3, 1.0, 2.25)
"""The multiples for a robot that goes by its lean alone."""
_PLAY: Final = 8
"""Periods of delay that the gears' play is worth to encoders. With gains that bear less, drawn robots swung."""
_TERMS: Final = 12  # of the series of an exponential
_LEAN: Final = 2  # states of a robot that goes by its lean alone: lean and rate
_STEP: Final = 1.5
_STEPS: Final = 6  # of a search for a gain that holds it: up to 11 times as much
_HALVINGS: Final = 4  # between two steps
_NAMES: Final = ("k1", "k2", "k3", "k4")


class Gains(NamedTuple):
    """Torque of both motors for each unit of an error, N m."""

    k1: float
    """For each rad of lean."""
    k2: float
    """For each rad/s."""
    k3: float
    """For each m."""
    k4: float
    """For each m/s."""


class Mechanics(NamedTuple):
    """The linear body near upright, with its wheels and rotors."""

    rolling: float
    """kg. All that an acceleration of the axle moves."""
    coupling: float
    """kg m. Between an acceleration of the axle and one of the lean."""
    tipping: float
    """kg m². About the axle."""
    gravity: float
    """N m/rad. What gravity gains on the body for each rad that it leans."""
    wheel_radius: float
    """m."""

    @property
    def turning_torque(self) -> float:
        """N m/rad. Torque that just ends the growth of a fall, for each rad of lean."""
        return self.rolling * self.gravity / (self.rolling + self.coupling / self.wheel_radius)

    def sampled(self, period: float = PERIOD) -> tuple[Rows, list[float]]:
        """Return what a state and a torque become in one period."""
        size = self.rolling * self.tipping - self.coupling**2
        rates = [[0.0] * 5 for _ in range(5)]  # of lean, its rate, place, speed; the fifth is the torque, which is held
        rates[0][1] = rates[2][3] = 1.0
        rates[1][0], rates[3][0] = self.rolling * self.gravity / size, -self.coupling * self.gravity / size
        rates[1][4] = -(self.rolling + self.coupling / self.wheel_radius) / size
        rates[3][4] = (self.tipping / self.wheel_radius + self.coupling) / size
        whole = term = _identity(5)
        for power in range(1, _TERMS):
            term = [[value * period / power for value in row] for row in _times(term, rates)]
            whole = [[a + b for a, b in zip(*rows, strict=True)] for rows in zip(whole, term, strict=True)]
        return [row[:4] for row in whole[:4]], [row[4] for row in whole[:4]]


@lru_cache(maxsize=4)
def _polynomials(mechanics: Mechanics, count: int) -> tuple[list[float], Rows]:
    """Return the body's polynomial of the shift by a period, and what the first `count` gains add to it.

    By Faddeev and LeVerrier. The search for other gains asks again and again, in a turn that stops motors, too.
    """
    a, b = mechanics.sampled()
    a = [row[:count] for row in a[:count]]
    body, added = [1.0], []
    power = _identity(count)
    for step in range(1, count + 1):
        added.append([sum(map(_product, row, b)) for row in power])
        power = _times(a, power)
        body.append(-sum(power[each][each] for each in range(count)) / step)
        for each in range(count):
            power[each][each] += body[-1]
    return body, added


class Loop:
    """A body and its gains."""

    def __init__(self, mechanics: Mechanics, gains: Gains) -> None:
        self._body, added = _polynomials(mechanics, 4 if gains.k3 or gains.k4 else _LEAN)
        self._fed = [sum(map(_product, gains, each)) for each in added]

    def holds(self, factor: float = 1.0, delays: Sequence[int] = DELAYS) -> bool:
        """Return whether all gains times `factor` are stable with each delay."""
        for delay in delays:
            closed = [*self._body, *([0.0] * delay)]
            for at, value in enumerate(self._fed, len(closed) - len(self._fed)):
                closed[at] -= factor * value
            if not is_stable(closed):
                return False
        return True

    @property
    def has_margin(self) -> bool:
        """Whether it holds the robot with the margin that gains must have."""
        if not self.has_encoders:
            return all(self.holds(factor) for factor in _LEAN_MARGIN)
        return self.holds(delays=(_PLAY,)) and all(self.holds(factor) for factor in MARGIN)

    @property
    def has_encoders(self) -> bool:
        """Whether the gains use them."""
        return len(self._fed) > _LEAN


def is_stable(polynomial: Sequence[float]) -> bool:
    """Return whether all roots are inside the unit circle (Jury's test). The highest power comes first."""
    left = list(polynomial)
    while len(left) > 1:
        reflected = left[-1] / left[0]
        if not abs(reflected) < 1.0:
            return False
        left = [a - reflected * b for a, b in zip(left[:-1], left[:0:-1], strict=True)]
    return True


def advice(mechanics: Mechanics, gains: Gains) -> str:
    """Return the smallest change of one gain that holds the robot, to 3 %. Empty: no single one does."""
    for step in range(1, _STEPS + 1):
        found: list[tuple[float, str]] = []
        for name, value in zip(_NAMES, gains, strict=True):
            for base in (_STEP, 1 / _STEP):
                power = _nearest(mechanics, gains, name, base, step)
                if power is not None:
                    change, beyond = ("raise", "more") if base > 1.0 else ("lower", "less")
                    found.append((power, f"{change} {name} to {_rounded(value * base**power):g} or {beyond}"))
        if found:
            return min(found)[1]
    return ""


def _nearest(mechanics: Mechanics, gains: Gains, name: str, base: float, step: int) -> float | None:
    """Return the least power of `base` on a gain that holds the robot, between the step before and this one."""
    value = getattr(gains, name)

    def holds(power: float) -> bool:
        return Loop(mechanics, gains._replace(**{name: _rounded(value * base**power)})).has_margin

    if not value or not holds(step):
        return None
    low, high = step - 1.0, float(step)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def _rounded(gain: float) -> float:
    return float(f"{gain:.4g}")


def _identity(size: int) -> Rows:
    return [[float(row == column) for column in range(size)] for row in range(size)]


def _times(a: Rows, b: Rows) -> Rows:
    columns = [*zip(*b, strict=True)]
    return [[sum(map(_product, row, column)) for column in columns] for row in a]


def _product(a: float, b: float) -> float:
    return a * b
