"""A sensor that is not heard tells nothing: its silence is no freedom."""

import math

from giraff_core.freshness import age
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
        return Trouble(f"{sensor} is stale ({last})", f"check giraff_{service} and its board")
    return NO_TROUBLE
