"""The requester's side of a motion or a route: what it says, what it concludes, and the one order of its steps.

The requester holds on to the motion as a hand holds a key down: with each tick of the robot that it has heard, and with
no other. One that is killed, cut off or suspended hears none, and its motion ends. No I/O and no clock.
"""

import math
from collections.abc import Callable
from typing import Any, Final

from giraff_core.motion.result import Ending, MotionResult, result_of
from giraff_core.motion.wish import RouteWish, Wish
from giraff_core.operator import LINK_SILENCE, RobotLink
from giraff_core.retry import RetriedRequest
from giraff_core.timer import Timer
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.motion import MotionAnswer, MotionCancel, MotionGo, MotionHold, MotionState
from giraff_schemas.places import PlacesGo
from giraff_schemas.topics import Query

ANSWERS_WITHIN: Final = 3.0
"""s for an answer, with some attempts that are lost."""
ENDS_WITHIN: Final = 2.5
"""s from a cancel to its end: motion stops at once, waits until the robot rests, and would stop for want of holds."""

_CHECK: Final = "check that {0} runs; on a secured network [network.access] says who may ask"
_NO_ANSWER: Final = f"nobody has answered within {ANSWERS_WITHIN:g} s; {_CHECK}"
_SILENT: Final = f"{{0}} is silent for {{1:g}} s; the robot stops for want of holds; {_CHECK}"
_ANOTHER: Final = "another {0} speaks: it was started anew, or there are two; let one run, and ask again"


class MotionRequester:
    """One wish, from the moment it is made to its end. Times are seconds of any one monotonic clock."""

    def __init__(self, id_: int, wish: Wish | RouteWish, by: str, instance: str) -> None:
        """`id_`: random and not 0. `instance`: that its holds carry."""
        self.wish = wish
        self._id, self._by, self._own = id_, by, instance
        self._link = RobotLink()
        self._timer = Timer(wish.asked.hold.rate_hz)
        self._held: RobotTime | None = None
        self._asked_at = self._heard = math.inf
        self._looked = self._woke = -math.inf
        self._cancelled_at: float | None = None
        self._answer: MotionAnswer | None = None
        self._instance = self._fault = ""
        self._lost: tuple[Ending, str] | None = None
        self.state: MotionState | None = None
        """The newest of this motion; None: none was heard."""

    @property
    def _begun(self) -> bool:
        return self.state is not None or (self._answer is not None and self._answer.accepted)

    @property
    def _has_ended(self) -> bool:
        """For good, whatever comes after it."""
        return self.state is not None and self.state.stage == "ended"

    @property
    def cancelled(self) -> bool:
        """It is to end."""
        return self._cancelled_at is not None

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock as it arrives."""
        self._link.on_tick(tick, now)

    def ask(self, now: float) -> MotionGo | PlacesGo | None:
        """The request, once: with the newest tick that was heard; None: none was heard yet. Raises ValueError."""
        if self._link.tick is None or self._link.link_fault(now):
            return None
        self._asked_at = now
        return self.wish.request(self._by, self._id, self._own, self._link.tick)

    def on_answer(self, answer: MotionAnswer, now: float) -> None:
        """Take what the service answers."""
        if self._answer is None:
            self._answer, self._heard = answer, now

    def on_fault(self, fault: str) -> None:
        """Take why there is no answer yet."""
        self._fault = fault

    def on_state(self, state: MotionState, now: float) -> None:
        """Take what is said of motions, of this one and of others."""
        if self._lost is not None or self._has_ended:
            return
        if state.id == self._id and self._instance in ("", state.instance):
            if self.state is None or state.seq > self.state.seq:
                self.state, self._instance, self._heard = state, state.instance, now
        elif self.state is not None:
            if state.instance != self._instance:
                self._lost = "unheard", self._told(_ANOTHER)
            elif state.seq > self.state.seq:
                self._lost = "unheard", f"the motion of {state.by} has come after it, and its own end was not heard"

    def hold(self, now: float) -> MotionHold | None:
        """What to say now to keep it going; None: nothing. Never a tick twice, and none that was not heard."""
        if now - self._looked > LINK_SILENCE:  # it stood still itself: what was said meanwhile is heard first
            self._woke = self._heard = now
        self._looked = now
        tick = self._link.tick
        if not self._begun or self.cancelled or self.result(now) is not None or not self._timer.due(now):
            return None
        if tick is None or tick == self._held:
            return None
        self._held = tick
        return MotionHold(id=self._id, tick=tick)

    def cancel(self, now: float) -> MotionCancel:
        """Let go of it, from now on; what to ask until it is answered."""
        if self._cancelled_at is None:
            self._cancelled_at = now
        return MotionCancel(by=self._by, id=self._id)

    def result(self, now: float) -> MotionResult | None:
        """How it has ended, or why it is given up; None: it goes on."""
        if (state := self.state) is not None and state.stage == "ended":
            return result_of(state, state.outcome, str(state.reason), begun=True)
        if state is None and self._answer is not None and not self._answer.accepted:
            return result_of(None, "refused", str(self._answer.reason), begun=False)
        if self._cancelled_at is not None:
            return self._after_cancel(self._cancelled_at, now)
        if self._lost is not None:
            return result_of(state, *self._lost, begun=True)
        if self._asked_at > now:
            return None
        if now - self._woke > LINK_SILENCE and (fault := str(self._link.link_fault(now))):
            return result_of(state, "lost_robot", fault, begun=self._begun)
        if not self._begun:
            late = now - self._asked_at > ANSWERS_WITHIN
            why = f"{self._fault}; {self._told(_CHECK)}" if self._fault else self._told(_NO_ANSWER)
            return result_of(None, "unanswered", why, begun=False) if late else None
        is_silent = now - self._heard > self.wish.asked.silence
        return result_of(state, "unheard", self._told(_SILENT), begun=True) if is_silent else None

    def _after_cancel(self, since: float, now: float) -> MotionResult | None:
        if self._asked_at <= since and now - since <= ENDS_WITHIN:
            return None
        if not self._begun:
            return result_of(None, "cancelled", self._told("cancelled before {0} had accepted it"), begun=False)
        _, why = self._lost or ("", "")
        why = why or str(self._link.link_fault(now)) or f"its end was not heard within {ENDS_WITHIN:g} s of the cancel"
        return result_of(self.state, "unheard", why, begun=True)

    def _told(self, text: str) -> str:
        return text.format(self.wish.asked.service, self.wish.asked.silence)


class HeldMotion:
    """A motion that somebody asks for, holds on to and ends.

    Call `turn` often until it returns how the motion has ended. Who stops calling lets go. Times: monotonic, s.
    """

    def __init__(
        self,
        requester: MotionRequester,
        ask: Callable[[Query[Any, Any], Any], RetriedRequest[Any]],
        hold: Callable[[MotionHold], object],
    ) -> None:
        """`ask` begins to ask the service. `hold` says that the motion is still wished."""
        self._requester, self._ask, self._hold = requester, ask, hold
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
        elif (request := requester.ask(now)) is not None:
            self._asking = self._ask(requester.wish.asked.go, request)
            self._asking.poll(now)
        if (hold := requester.hold(now)) is not None:
            self._hold(hold)
        return requester.result(now)

    def cancel(self, now: float) -> None:
        """Let go of it, and ask for its end; `turn` tells of it."""
        request = self._requester.cancel(now)
        if self._cancelling is None:
            self._cancelling = self._ask(self._requester.wish.asked.cancel, request)
