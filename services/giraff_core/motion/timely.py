"""Requests to move: each is met once, and only a wish of now begins anything. No I/O and no clock."""

import math
from collections.abc import Callable
from typing import Final

from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import MotionAnswer, MotionRequest
from giraff_schemas.places import PlacesGo
from giraff_schemas.trouble import NO_TROUBLE, Trouble

WISH_COUNTS: Final = 1.0
"""s after which a request is too old to begin anything."""
AHEAD: Final = 0.1
"""s by which a requester may have heard a newer tick than this process."""
_REMEMBERED: Final = 64
"""Requests that are met once."""


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


class AnswersOnce:
    """Answers to requests, so that each is met once: asked again with the same id, it is the first answer."""

    def __init__(self) -> None:
        self._answers: dict[int, MotionAnswer] = {}

    def answer(self, id_: int, begin: Callable[[], Trouble]) -> MotionAnswer:
        """Begin what is asked, unless it was asked before. `begin`: returns why it has not begun."""
        if (met := self._answers.get(id_)) is not None:
            return met
        why = begin()
        answer = self._answers[id_] = MotionAnswer(accepted=not why, reason=why)
        if len(self._answers) > _REMEMBERED:
            del self._answers[next(iter(self._answers))]
        return answer
