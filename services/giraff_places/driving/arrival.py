"""Judges how far the robot is from its goal, and whether that is known. No I/O and no clock."""

import math
from typing import Final, NamedTuple

from giraff_schemas.localization import MapPose
from giraff_schemas.places import Goal

_DOUBTFUL: Final = (0.2, math.radians(8.0))
"""m and rad, standard deviations with which nobody knows."""
_EXPLAINS: Final = {False: 0.8, True: 0.75}
"""Share of the readings that the place must explain. Sonars of a robot that was carried away 2 m before its goal leave
0.70, and of others 0.86 or more: measured in the furnished flat."""


class Off(NamedTuple):
    """Way that is left to a goal."""

    metres: float
    turn: float
    """rad; 0 where any heading will do."""

    @classmethod
    def of(cls, pose: MapPose, goal: Goal) -> "Off":
        """Return it for a robot that is at a pose."""
        turn = 0.0 if goal.yaw is None else math.remainder(goal.yaw - pose.yaw, math.tau)
        return cls(math.dist((pose.x, pose.y), (goal.x, goal.y)), turn)

    def is_within(self, most: "Off") -> bool:
        """Tell whether neither is more."""
        return self.metres <= most.metres and abs(self.turn) <= most.turn


NEAR: Final = Off(0.08, math.radians(3.0))
"""Needs no correction."""
AT_GOAL: Final = Off(0.25, math.radians(15.0))
"""Most of a robot that has arrived."""


def is_doubtful(pose: MapPose, *, has_looked: bool) -> bool:
    """Tell whether localization is too unsure for an arrival. `has_looked`: the robot has turned round to see more."""
    x, y, yaw = pose.standard_deviations
    return max(x, y) > _DOUBTFUL[0] or yaw > _DOUBTFUL[1] or pose.explained < _EXPLAINS[has_looked]
