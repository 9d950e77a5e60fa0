"""Freshness without synchronized clocks: how old a sample is, told by the robot's own ticks."""

import math
from typing import Final

from giraff_schemas.messages import RobotTime, Tick

_EPOCHS: Final = 8  # of base's starts that are remembered: what an older one once said is not met any more
_HOLDS: Final = 0.2
"""s; ten ticks. A false one that lies ahead makes nobody deaf for longer."""


def age(tick: RobotTime | None, now: RobotTime) -> float:
    """Upper bound (s) of the true age of what carries `tick`.

    Infinite when nothing is proven: no tick, a tick of another epoch or of nobody's, or one ahead of `now`.
    """
    if tick is None or tick.epoch == 0 or tick.epoch != now.epoch or tick.robot_ns > now.robot_ns:
        return math.inf
    return (now.robot_ns - tick.robot_ns) * 1e-9


def age_here(tick: RobotTime | None, newest: RobotTime, since: float) -> float:
    """Age (s) of what carries `tick`, on a host that heard the tick `newest` `since` s ago.

    What comes over another link may carry a tick that this host has not heard yet.
    """
    if tick is not None and tick.robot_ns > newest.robot_ns and not math.isinf(ahead := age(newest, tick)):
        return max(0.0, since - ahead)
    return age(tick, newest) + since


class TickFilter:
    """Base's ticks as a host receives them: late, twice, overtaken, or once again.

    What stands on a later measurement must never carry an older tick than what came before it. Else it would be
    refused for its age, and the older command would go on in its place.
    """

    def __init__(self) -> None:
        self._newest: dict[int, tuple[int, float]] = {}  # robot_ns, and when it came, by epoch: one for each base

    def is_newer(self, tick: Tick, now: float) -> bool:
        """Whether this tick is newer than those of its epoch that came just before; only then does it count.

        `now`: s of any one monotonic clock.
        """
        newest, at = self._newest.pop(tick.epoch, (-1, 0.0))
        if old := tick.robot_ns <= newest and now - at <= _HOLDS:
            self._newest[tick.epoch] = newest, at
        else:
            self._newest[tick.epoch] = tick.robot_ns, now
        if len(self._newest) > _EPOCHS:
            del self._newest[next(iter(self._newest))]
        return not old


def derate(age_s: float, budget: float) -> float:
    """Share of the speed that a sample of this age still earns: 1 up to half its budget, then falling to 0 at it."""
    return min(1.0, max(0.0, 2.0 - 2.0 * age_s / budget))
