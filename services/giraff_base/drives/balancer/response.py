"""How a robot that balances moves near upright: its linear body under its gains, as the board applies them."""

from collections import deque
from collections.abc import Iterator
from typing import Final, NamedTuple

from giraff_base.drives.balancer.stability import DELAYS, PERIOD, Gains, Mechanics

LEASH: Final = 0.05
"""m. Beyond it the held place follows the robot."""
_SPEED_ERROR_MAX: Final = 0.4  # m/s that count
_STOPS_WITHIN: Final = 3.0  # s


class Moment(NamedTuple):
    """The robot after a period."""

    lean: float
    """rad."""
    rate: float
    """rad/s."""
    way: float
    """m from the held place as it was at first."""
    speed: float
    """m/s."""
    torque: float
    """N m that the board asks of both motors. It acts some periods later."""


def respond(
    mechanics: Mechanics, gains: Gains, torque_max: float, *, way: float = 0.0, speed: float = 0.0
) -> Iterator[Moment]:
    """Yield what follows each period, without end, where it is to stand. `way`, `speed`: m and m/s at first."""
    a, b = mechanics.sampled()
    lean = rate = 0.0
    ahead = way
    waiting = deque([0.0] * DELAYS[-1])
    while True:
        error = max(-_SPEED_ERROR_MAX, min(_SPEED_ERROR_MAX, speed))
        asked = gains.k1 * lean + gains.k2 * rate + gains.k3 * ahead + gains.k4 * error
        asked = max(-torque_max, min(torque_max, asked))
        waiting.append(asked)
        torque, before, state = waiting.popleft(), way, (lean, rate, way, speed)
        lean, rate, way, speed = (
            sum(map(float.__mul__, row, state)) + by * torque for row, by in zip(a, b, strict=True)
        )
        ahead = max(-LEASH, min(LEASH, ahead + way - before))
        yield Moment(lean, rate, way, speed, asked)


def run_on(mechanics: Mechanics, gains: Gains, torque_max: float, speed: float, braking: float) -> float:
    """Return the m by which a halt from `speed` goes on beyond a stop at `braking` m/s²."""
    moments = respond(mechanics, gains, torque_max, speed=speed)
    farthest = max(next(moments).way for _ in range(round(_STOPS_WITHIN / PERIOD)))
    return farthest - speed * speed / (2.0 * braking)
