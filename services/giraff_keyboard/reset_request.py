"""The key R: asks base to release the emergency stop that is shown, once a second key has said yes to it.

A reset permits motion and never causes it; still, no stray byte, held key or pasted text is to give one. So there are
two keys, neither of which repeats into the other, with time between them to read what is asked.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

from giraff_core.estop.release import EStopRelease
from giraff_core.estop.request import Request
from giraff_keyboard.policy import Key
from giraff_schemas.messages import EStop, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

READ_FIRST: Final = 0.5
"""s after the question within which a yes is no answer to it: words that are typed have R and Y, too."""
ASKS_FOR: Final = 5.0
"""s that the question stands."""
_NOT_ENGAGED: Final = Trouble("Nothing to release: the emergency stop is not engaged")


def before_release(head: str, latch: EStop) -> Trouble:
    """Return who has stopped the robot and why, with what is to be done before a release."""
    command = latch.reason.argument
    what = f"{head} {latch.by}: {latch.reason.what}"
    return Trouble(what, latch.reason.remedy, "run" if command else "", command)


def release_question(latch: EStop) -> Trouble:
    """Return the question to the person."""
    return before_release("RELEASE? y: yes, any other key: no. It is the stop by", latch)


class _Question(NamedTuple):
    latch: EStop
    asked: float
    """When, s."""


class ResetRequest(EStopRelease):
    """Times are monotonic, s."""

    def __init__(self, ask: Callable[[EStop, RobotTime], Request]) -> None:
        """`ask` begins to ask base to clear the latch that is shown so; with the robot's time of the human's wish."""
        super().__init__()
        self._begin = ask
        self._question: _Question | None = None

    def on_key(self, key: Key, moment: RobotTime | None, now: float, *, stopping: bool) -> None:
        """Take a press. `moment`: the robot's time now, None while it is lost; `stopping`: a stop is not confirmed."""
        question, self._question, self.outcome = self._question, None, NO_TROUBLE
        if key is Key.STOP:
            self.withdraw()  # who wants a stop wants no release any more
        elif stopping or self.is_asked:
            pass
        elif key is Key.RESET:
            self._ask_person(now)
        elif key is Key.YES and question is not None:
            self._answer(question, moment, now)

    def poll(self, now: float) -> bool:
        if self._question is not None and now - self._question.asked > ASKS_FOR:
            self._question, self.outcome = None, NO_TROUBLE
        return super().poll(now)

    def _ask_person(self, now: float) -> None:
        latch, self.outcome = self._shown(now)
        if latch is not None:
            self._question = _Question(latch, now)
            self.outcome = release_question(latch)

    def _answer(self, question: _Question, moment: RobotTime | None, now: float) -> None:
        if now - question.asked < READ_FIRST:
            self.outcome = Trouble("Nothing is released: that was too quick", "press r, read, then y")
            return
        latch, self.outcome = self._shown(now)
        if latch is None:
            return
        if _identity(latch) != _identity(question.latch):
            self.outcome = Trouble("Nothing is released: there is another stop now", "press r to see it")
        elif moment is None:
            self.outcome = Trouble("Nothing is released: the robot is not heard", "press r when it is")
        else:
            self.ask(self._begin(latch, moment), now)

    def _shown(self, now: float) -> tuple[EStop | None, Trouble]:
        """The latch that is engaged now; else why there is none to release."""
        states = [state for state, _ in self.states(now)]
        if not states:
            return None, Trouble("Nothing is released: base is not heard")
        if len(states) > 1:
            several = f"Nothing is released: {len(states)} bases have this robot's name"
            return None, Trouble(several, "end all but one")
        [state] = states
        return (state, NO_TROUBLE) if state.engaged else (None, _NOT_ENGAGED)


def _identity(latch: EStop) -> tuple[str, int, int]:
    """Another one: it is another base's, another cause's, or somebody has asked for it again."""
    return latch.instance, latch.id, latch.engaged_ns
