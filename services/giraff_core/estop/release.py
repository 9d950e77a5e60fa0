"""A person's release of the emergency stop: one request at a time, and what became of it."""

from typing import Final

from giraff_core.estop.request import Request
from giraff_schemas.messages import EStop, Sample
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_STATE_LASTS: Final = 1.5  # s that base's word of its stop is of now
_GIVES_UP: Final = 2.0  # s; base takes no reset whose tick is older than a second


class EStopRelease:
    """Asks base until it answers. Times are monotonic, s."""

    def __init__(self) -> None:
        self.outcome = NO_TROUBLE
        """What the person who asked must know. NO_TROUBLE: nothing."""
        self._request: Request | None = None
        self._requested = 0.0
        self._states: dict[str, tuple[EStop, float]] = {}
        """By base, its newest word, and when it came."""

    @property
    def is_asked(self) -> bool:
        """Whether a release was asked for that base has not answered."""
        return self._request is not None

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take what base says of its stop."""
        if isinstance(sample, EStop):
            self._states[sample.instance] = sample, now

    def states(self, now: float) -> list[tuple[EStop, float]]:
        """Return each base's newest word that is of now, and when it came."""
        self._states = {base: heard for base, heard in self._states.items() if now - heard[1] <= _STATE_LASTS}
        return list(self._states.values())

    def ask(self, request: Request, now: float) -> None:
        """Go on with this request, in place of the one before."""
        self._request, self._requested = request, now
        self.outcome = Trouble("RELEASING, not confirmed yet")

    def withdraw(self) -> None:
        """Ask no more."""
        self._request, self.outcome = None, NO_TROUBLE

    def poll(self, now: float) -> bool:
        """Go on asking. Return whether base has answered just now."""
        if self._request is None:
            return False
        answer = self._request.poll(now)
        if answer is not None:
            self.outcome = NO_TROUBLE if answer.done and not answer.engaged else answer.reason.of("STILL STOPPED")
        elif now - self._requested > _GIVES_UP:
            fault = self._request.fault or "base does not answer"
            self.outcome = Trouble(f"RELEASE NOT CONFIRMED: {fault}", "ask again")
        else:
            return False
        self._request = None
        return answer is not None
