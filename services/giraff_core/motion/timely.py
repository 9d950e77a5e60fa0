"""Whether a request to move is a wish of now. No I/O and no clock: the robot's ticks tell."""

import math
from typing import Final

from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import MotionRequest
from giraff_schemas.places import PlacesGo
from giraff_schemas.trouble import NO_TROUBLE, Trouble

WISH_COUNTS: Final = 1.0
"""s after which a request is too old to begin anything."""
AHEAD: Final = 0.1
"""s by which a requester may have heard a newer tick than this process."""


def age_of(tick: RobotTime | None, newest: RobotTime | None) -> float:
    """Return s before the newest tick that was heard, negative when it is newer; infinite: of another clock."""
    if tick is None or newest is None or tick.epoch != newest.epoch:
        return math.inf
    return (newest.robot_ns - tick.robot_ns) * 1e-9


def untimely(request: MotionRequest | PlacesGo, newest: RobotTime | None) -> Trouble:
    """Return why it is no new wish of now."""
    if request.id == 0:
        return Trouble("its id is 0", "give a random one, other for each request")
    if not request.instance:
        return Trouble("its instance is empty", "give the one that its holds carry")
    old = age_of(request.tick, newest)
    if -AHEAD <= old <= WISH_COUNTS:
        return NO_TROUBLE
    if math.isfinite(old) and old > 0.0:
        return Trouble(f"it was wished {old:.1f} s ago", "ask again")
    return Trouble("its tick is of another start of base, or of another robot", "ask again")
