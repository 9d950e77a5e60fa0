"""A motion that somebody asks for, holds on to and ends: the one order of these steps. No I/O and no clock."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from giraff_core.motion.requester import MotionRequester
from giraff_core.motion.result import MotionResult
from giraff_core.retry import RetriedRequest
from giraff_schemas.motion import MotionHold, Step
from giraff_schemas.topics import MOTION_CANCEL, MOTION_GO, Query


class HeldMotion:
    """Call `turn` often until it returns how the motion has ended. Who stops calling lets go. Times: monotonic, s."""

    def __init__(
        self,
        requester: MotionRequester,
        ask: Callable[[Query[Any, Any], Any], RetriedRequest[Any]],
        hold: Callable[[MotionHold], object],
        steps: Sequence[Step],
        *limits: float | None,
    ) -> None:
        """`ask` begins to ask giraff_motion. `hold` says that the motion is still wished.

        `limits`: m/s, rad/s and s, as of `MotionRequester.ask`.
        """
        self._requester, self._ask, self._hold = requester, ask, hold
        self._steps, self._limits = steps, limits
        self._asking: RetriedRequest[Any] | None = None
        self._cancelling: RetriedRequest[Any] | None = None

    @property
    def has_asked(self) -> bool:
        """It has heard the robot, and has asked."""
        return self._asking is not None

    @property
    def is_cancelled(self) -> bool:
        """Its end was asked for."""
        return self._cancelling is not None

    def turn(self, now: float) -> MotionResult | None:
        """Return how it has ended; None: it goes on. Raises ValueError for a wish of no numbers."""
        requester = self._requester
        if self._cancelling is not None:
            self._cancelling.poll(now)
        elif self._asking is not None:
            if (answer := self._asking.poll(now)) is not None:
                requester.on_answer(answer, now)
            requester.on_fault(self._asking.fault)
        elif (request := requester.ask(now, self._steps, *self._limits)) is not None:
            self._asking = self._ask(MOTION_GO, request)
            self._asking.poll(now)
        if (hold := requester.hold(now)) is not None:
            self._hold(hold)
        return requester.result(now)

    def cancel(self, now: float) -> None:
        """Let go of it, and ask for its end; `turn` tells of it."""
        request = self._requester.cancel(now)
        if self._cancelling is None:
            self._cancelling = self._ask(MOTION_CANCEL, request)
