"""A sensor that is not heard, or tells nothing, is blind: its silence is no freedom."""

import math

from giraff_core.freshness import age
from giraff_guard.source import Sight
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble


def silence(sensor: str, service: str, tick: RobotTime | None, budget: float, now: RobotTime) -> Trouble:
    """Return why the newest sample of a sensor does not count any more; NO_TROUBLE: it does.

    `service`: publishes it. `tick`: moment of the sample; None: there was none. `budget`: s that it counts.
    """
    if tick is None:
        return Trouble(f"{sensor} has not been heard yet", f"start giraff_{service}")
    if (old := age(tick, now)) > budget:
        last = f"{old:.1f} s old" if math.isfinite(old) else "of no known age"
        return Trouble(f"{sensor} is stale ({last})", f"check giraff_{service} and what it reads")
    return NO_TROUBLE


def unusable(sight: Sight, *, sees_ahead: bool) -> Trouble:
    """Return why the evidence of a sensor that is heard does not count: there is none, or it is no number."""
    points = sight.points
    if sees_ahead and not (sight.blind or sight.touch or sight.readings or points is not None):
        return Trouble(f"{sight.sensor} tells nothing of this way")
    numbers = [sight.doubtful_speed, *(number for each in sight.readings for number in (each.gap, each.came))]
    if points is not None:
        numbers += [points.spread, points.reach, *(each for place in points.xy for each in place)]
    if any(map(math.isnan, numbers)):
        return Trouble(f"{sight.sensor} tells a distance that is no number")
    return NO_TROUBLE
