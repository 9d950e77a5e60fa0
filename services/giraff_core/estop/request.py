"""A person's emergency stop: asked for until base has confirmed it."""

from collections.abc import Callable
from typing import Final, Protocol

from giraff_core.estop.latch import is_confirmed_stop
from giraff_schemas.messages import EStop, Sample
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.text import printable
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_NO_OFF: Final = "this robot's drive has no other off"
BY_WORD: Final = "by the word of whoever answers as its base on this open network"
"""Stands behind each stop that is confirmed where a stranger can answer and publish in base's name."""
_MOST_BASES: Final = 16  # whose states are kept; on an open network anybody may tell one


def board_note(unheard_stops_s: float) -> str:
    """Return what stands behind a stop where base hears no board: that board hears no base either, and then stops."""
    return f"; its board is not heard, and stops by itself within {unheard_stops_s:g} s" if unheard_stops_s else ""


def stop_word(note: str) -> str:
    """Return the words for a stop that base has confirmed. `note`: of a board that it does not hear."""
    return "ASKED TO STOP" if note else "STOPPED"


def not_off(note: str = "") -> str:
    """Return the words for a stop that was to be off. `note`: says why it is not, and stands behind them."""
    return f"{stop_word(note)}, not off" if note else f"STOPPED, not off: {_NO_OFF}"


class StopConfirmation:
    """Judges the answers to one request to stop by what base itself tells meanwhile.

    Anybody may answer on an open network. So an answer counts only beside an `estop` sample of the same instance, which
    says that the same latch is engaged. Where the liveliness tokens of several bases are known, each must confirm.
    """

    def __init__(self, robot: str = "this robot") -> None:
        """`robot`: what its bases are called."""
        self._robot = robot
        self._stated: dict[str, EStop] = {}  # by instance
        self._answers: dict[str, EStopAnswer] = {}  # by instance, the newest that counted
        self._alive: set[str] = set()  # instances

    def on_sample(self, estop: EStop) -> None:
        """Take what a base tells, from any thread."""
        self._stated.pop(estop.instance, None)
        self._stated[estop.instance] = estop
        if len(self._stated) > _MOST_BASES:
            del self._stated[next(iter(self._stated))]

    def on_base(self, instance: str, *, present: bool) -> None:
        """Take that the liveliness token of a base has come or gone, from any thread."""
        (self._alive.add if present else self._alive.discard)(instance)

    @property
    def is_off(self) -> bool:
        """Return True if each base that has confirmed tells that its stop is off, and reaches its board."""
        states = [self._stated.get(instance) for instance in self._answers]
        return bool(states) and all(state is not None and state.off for state in states) and not self.note

    @property
    def note(self) -> str:
        """Return what `board_note` says of a base that has stopped and does not hear its board; else nothing."""
        return board_note(max((answer.unheard_stops_s for answer in [*self._answers.values()]), default=0.0))

    def judge(self, answer: EStopAnswer) -> bool | str:
        """Return whether each base has stopped and will stay so, or why this answer does not tell."""
        if not answer.engaged:
            self._answers.pop(answer.instance, None)
            return False
        if not self._is_stated(answer):
            whose = f"base {printable(answer.instance[:8])}"
            return f"an answer says that latch {answer.id} is engaged, but no estop sample of {whose} says so"
        self._answers[answer.instance] = answer
        if len(self._answers) > _MOST_BASES:
            del self._answers[next(iter(self._answers))]
        return self.unconfirmed(for_good=answer.done) or is_confirmed_stop(answer)

    def unconfirmed(self, *, for_good: bool = False) -> str:
        """Tell of bases of one name that have not all stopped; empty: all have, or none has. `for_good`: and saved it.

        A base that ended uncleanly counts until the network drops its token.
        """
        stopped = {
            instance
            for instance, answer in self._answers.items()
            if self._is_stated(answer) and (answer.done or not for_good)
        }
        if not stopped or self._alive <= stopped:
            return ""
        known = len(self._alive | stopped)
        told = ", ".join(sorted(printable(instance[:8]) for instance in stopped))
        return (
            f"{known} bases are called {self._robot}; only {told} confirmed; end all but one "
            "(one that has crashed or lost its network counts until the network drops it, some seconds)"
        )

    def _is_stated(self, answer: EStopAnswer) -> bool:
        stated = self._stated.get(answer.instance)
        return stated is not None and stated.engaged and stated.id == answer.id


class Request(Protocol):
    """One request that is repeated until base confirms."""

    @property
    def fault(self) -> str: ...
    @property
    def attempts(self) -> int: ...
    @property
    def refusal(self) -> EStopAnswer | None: ...
    def poll(self, now: float) -> EStopAnswer | None: ...


class EStopRequest:
    """Asks base until it says that it has stopped and will stay so. Times are monotonic, s."""

    def __init__(
        self,
        ask: Callable[[Callable[[EStopAnswer], bool | str], bool], Request],
        *,
        is_open: bool,
    ) -> None:
        """`ask` begins to ask, for off or for a plain stop, until an answer settles it. `is_open`: of the network."""
        self.outcome = NO_TROUBLE
        """What the person who asked must know."""
        self.refused_off = NO_TROUBLE
        """The same, where base has stopped the robot but has not switched it off, as it was asked."""
        self._off = False  # what the request asks for
        self._ask = ask
        self._is_open = is_open
        self._request: Request | None = None
        self._confirmation = StopConfirmation()

    @property
    def asked(self) -> bool:
        """Whether a stop was asked for that base has not confirmed."""
        return self._request is not None

    def engage(self, *, off: bool = False) -> None:
        """A stop is wished; `off`: and that it is off. That takes the place of a plain stop that is under way."""
        if self._request is None or (off and not self._off):
            self._off, self.refused_off = off, NO_TROUBLE
            self._confirmation = StopConfirmation()
            self._request = self._ask(self._confirmation.judge, off)
            self._report(self._request)

    def poll(self, now: float) -> bool:
        """Go on asking; whether base has confirmed just now."""
        if self._request is None:
            return False
        if self._request.poll(now) is not None:
            self._request = None
            is_off, note = self._confirmation.is_off, self._confirmation.note
            word = f", {BY_WORD}" if self._is_open else ""
            if self._off and not is_off:
                self.outcome = self.refused_off = Trouble(f"{not_off(note)}{word}{note}", action="release")
            else:
                what = "OFF" if is_off else stop_word(note)
                self.outcome = Trouble(f"{what}{word or ': base has confirmed'}{note}", action="release")
            return True
        self._report(self._request)
        return False

    def on_sample(self, sample: Sample) -> None:
        """Take what base says. It confirms a stop together with an answer, and may be released again."""
        if not isinstance(sample, EStop):
            return
        self._confirmation.on_sample(sample)
        if not sample.engaged and not self.asked:
            self.outcome = self.refused_off = NO_TROUBLE

    def _report(self, request: Request) -> None:
        refusal = Trouble(request.fault) if request.refusal is None else request.refusal.reason.of("base answers")
        why = f": {refusal.what}" if refusal else ""
        what = f"{'SWITCHING OFF' if self._off else 'STOPPING'}, NOT CONFIRMED after {request.attempts} requests{why}"
        remedy = "; ".join(filter(None, ("if it moves, use the battery switch", refusal.remedy)))
        self.outcome = Trouble(what, remedy)
