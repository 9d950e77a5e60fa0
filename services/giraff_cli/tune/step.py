"""A step of the held place, on the linear body with delay and a bounded torque."""

from __future__ import annotations

from collections import deque
from typing import Final, NamedTuple

from giraff_base.drives.balancer.config import BalancingBody
from giraff_base.drives.balancer.stability import DELAYS, PERIOD, Gains

STEP: Final = 0.05
"""m. The board lets the held place be no farther away."""
SECONDS: Final = 8.0
_ARRIVED: Final = 0.1  # of the step: it stays within


class Response(NamedTuple):
    """What a robot does that stands and is to hold another place."""

    way: list[float]
    """m from where it stood, for each period."""
    lean: float
    """rad. Largest one."""
    torque: float
    """N m. Largest one."""

    @property
    def settled(self) -> float | None:
        """Return the s after which it stays within a tenth of the step. None: it does not."""
        late = [at for at, way in enumerate(self.way, 1) if abs(way - STEP) > _ARRIVED * STEP]
        return None if late and late[-1] == len(self.way) else (late[-1] if late else 0) * PERIOD


def respond(body: BalancingBody, gains: Gains) -> Response:
    """Return the response with the longest delay."""
    a, b = body.mechanics.sampled()
    state = [0.0, 0.0, -STEP, 0.0]
    waiting = deque([0.0] * DELAYS[-1])
    way, lean, most = [], 0.0, 0.0
    for _ in range(round(SECONDS / PERIOD)):
        asked = sum(map(float.__mul__, gains, state))
        waiting.append(max(-body.torque_max, min(body.torque_max, asked)))
        torque = waiting.popleft()
        state = [sum(map(float.__mul__, row, state)) + by * torque for row, by in zip(a, b, strict=True)]
        way.append(state[2] + STEP)
        lean, most = max(lean, abs(state[0])), max(most, abs(torque))
    return Response(way, lean, most)
