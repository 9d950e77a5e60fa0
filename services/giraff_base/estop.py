"""The emergency stop: who may engage it (anyone, at once), and what a reset must prove."""

from typing import Final

import msgspec

from giraff_core.estop.latch import RELEASED, SEE_THAT_IT_MAY, EStopLatch
from giraff_core.freshness import age
from giraff_schemas.messages import EStop, RobotTime
from giraff_schemas.requests import UNREADABLE_STOP, EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.text import brief
from giraff_schemas.trouble import NO_TROUBLE, Trouble

__all__ = ["RELEASED", "EStopControl", "EStopLatch"]

_IDS: Final = 1 << 31


class EStopControl:
    """Holds the latch in force."""

    def __init__(self, latch: EStopLatch, reset_budget: float, *, can_power_off: bool) -> None:
        """`can_power_off`: of the drive. Without it, nothing is off, and no one is told that it is."""
        # Somebody may have edited the file.
        off = latch.engaged and latch.off and can_power_off
        empty = latch.engaged and latch.empty
        reason = _to_release(latch.reason) if latch.engaged else NO_TROUBLE
        self.latch = msgspec.structs.replace(latch, by=brief(latch.by), reason=reason, off=off, empty=empty)
        self._can_power_off = can_power_off
        self._reset_budget = reset_budget
        self._engaged_ns = 0
        """Robot time of the newest engaging, of whatever cause; 0: none since the start."""
        self._sample: EStop | None = None
        self._sampled = self.latch  # that `_sample` tells of

    @property
    def stops(self) -> Trouble:
        """Why nothing may move."""
        latch = self.latch
        return latch.reason.of(f"emergency stop by {latch.by}") if latch.engaged else NO_TROUBLE

    def engage(self, asked: EStopEngage, now: RobotTime, *, empty: bool = False) -> None:
        """Engage. Repeating keeps the latch; another cause makes another one, which a reset of the first leaves.

        Only a request for off makes it off, however often a stop is asked for. Only a reset ends that, and that the
        battery was `empty`.
        """
        self._engaged_ns = now.robot_ns
        by, reason = brief(asked.by), _to_release(asked.reason)
        if asked == UNREADABLE_STOP and self.latch.engaged:
            by, reason = self.latch.by, self.latch.reason  # which somebody can read
        off = self.latch.off or (asked.off and self._can_power_off)
        empty = self.latch.empty or empty
        latch = EStopLatch(engaged=True, id=self.latch.id, by=by, reason=reason, off=off, empty=empty)
        if self.latch != latch:
            self.latch = msgspec.structs.replace(latch, id=self.latch.id % _IDS + 1)

    def is_news(self, latched: EStopEngage) -> bool:
        """Whether the board has latched more by itself than base asks of it."""
        return not self.latch.engaged or (latched.off and self._can_power_off and not self.latch.off)

    def refusal(self, reset: EStopReset, now: RobotTime) -> Trouble:
        """Return why this reset clears nothing. NO_TROUBLE: it may clear it, or the latch is cleared already."""
        latch = self.latch
        if reset.id != latch.id:
            other = f"latch {reset.id} is not the one engaged, which is"
            if latch.engaged:
                return latch.reason.of(f"{other} latch {latch.id} by {latch.by}")
            return Trouble(f"{other} none, it is released")
        if latch.engaged and age(reset.tick, now) > self._reset_budget:
            return Trouble(
                f"the reset is not from within the last {self._reset_budget:g} s", "ask again, with base heard"
            )
        is_old = reset.tick is not None and reset.tick.robot_ns < self._engaged_ns
        if latch.engaged and (is_old or reset.engaged_ns not in (None, self._engaged_ns)):
            return Trouble("the emergency stop was engaged again after this reset was asked for", "ask again")
        return NO_TROUBLE

    def released(self, reset: EStopReset) -> EStopLatch:
        """The latch as `reset` leaves it."""
        return EStopLatch(engaged=False, id=self.latch.id, by=brief(reset.by), reason=NO_TROUBLE)

    def answer(self, why_not: Trouble = NO_TROUBLE) -> EStopAnswer:
        """`why_not`: what was asked is not done, and why."""
        return EStopAnswer(done=not why_not, engaged=self.latch.engaged, id=self.latch.id, reason=why_not)

    def sample(self) -> EStop:
        """Return what there is to tell. It is asked for in each turn, and changes seldom."""
        latch, sample = self.latch, self._sample
        if sample is None or self._sampled is not latch or sample.engaged_ns != self._engaged_ns:
            self._sampled = latch
            sample = self._sample = EStop(
                engaged=latch.engaged,
                id=latch.id,
                by=latch.by,
                reason=latch.reason,
                engaged_ns=self._engaged_ns,
                off=latch.off,
            )
        return sample


def _to_release(cause: Trouble) -> Trouble:
    """Return the cause of a stop with the way to release it, whatever somebody wrote into request or file."""
    command = brief(cause.argument) if cause.action in {"run", "release"} else ""
    return Trouble(
        brief(cause.what) or "no reason was given", brief(cause.remedy) or SEE_THAT_IT_MAY, "release", command
    )
