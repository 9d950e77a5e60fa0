"""What the footprint meets of the points that a sensor sees now."""

import math
from collections.abc import Iterator

from giraff_core.kinematics.pose import Pose
from giraff_guard.geometry import until_touch
from giraff_guard.judge.memory import Obstruction
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.source import Reading, Sight


def in_the_way(
    sight: Sight, place: Pose, way: DriveDirection, limits: Limits, curvature: float = 0.0
) -> Iterator[Obstruction]:
    """Yield what a footprint driving this way meets of a sensor's points.

    `curvature`: angular_z / linear_x, 1/m.
    """
    if sight.points is None:
        return
    sign, reach = SIGN[way], limits.swept_radius + sight.points.spread
    for point in sight.points.xy:
        x, y = place.sees(*point)
        distance = until_touch(x * sign, y, curvature, reach)
        if distance is not None:
            yield Obstruction(distance, sight.sensor, math.atan2(y, x), is_old=False)


def with_reading(sight: Sight, place: Pose, way: DriveDirection, limits: Limits) -> Sight:
    """Return the sight with the reading that its points give straight ahead, the margin counted as in the memory.

    Beyond its reach something may stand.
    """
    points, config = sight.points, limits.config
    if points is None:
        return sight
    came = SIGN[way] * points.place.ahead(place, 0.0)
    unseen = points.reach - limits.footprint_radius - came
    nearest = min((each.distance for each in in_the_way(sight, place, way, limits)), default=math.inf)
    seen = nearest + min(config.margin, config.memory_margin)
    gap = min(seen, unseen)
    return sight._replace(readings=(Reading(gap + came, came, gap, is_echo=seen <= unseen),))


def touches(sight: Sight, place: Pose, limits: Limits) -> bool:
    """Return whether a point lies within the footprint and its margin."""
    if sight.points is None:
        return False
    reach = limits.swept_radius + sight.points.spread
    return any(math.hypot(*place.sees(*point)) < reach for point in sight.points.xy)
