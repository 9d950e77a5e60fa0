"""A step of the held place, on the linear body with delay and a bounded torque."""

from __future__ import annotations

from typing import Final, NamedTuple

from giraff_base.drives.balancer.config import BalancingBody
from giraff_base.drives.balancer.response import LEASH, respond
from giraff_base.drives.balancer.stability import PERIOD, Gains

STEP: Final = LEASH
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


def respond_to_step(body: BalancingBody, gains: Gains) -> Response:
    """Return the response with the longest delay."""
    moments = respond(body.mechanics, gains, body.torque_max, way=-STEP)
    kept = [next(moments) for _ in range(round(SECONDS / PERIOD))]
    return Response(
        way=[each.way + STEP for each in kept],
        lean=max(abs(each.lean) for each in kept),
        torque=max(abs(each.torque) for each in kept),
    )
