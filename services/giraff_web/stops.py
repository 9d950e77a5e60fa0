"""The emergency stop and its release, asked for on pages: a stop is never refused nor put off. No clock.

A latch that is shown as engaged answers further stops by itself. A release that somebody has asked for elsewhere may be
on its way meanwhile: so such a stop stands until base was heard engaged when no earlier release can come any more. If
base is heard released before, it is asked for.
"""

import math
from collections.abc import Callable
from typing import Final

from giraff_core.estop.release import EStopRelease
from giraff_core.estop.request import EStopRequest, Request
from giraff_schemas.messages import EStop
from giraff_schemas.requests import EStopAnswer, EStopReset
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_STANDS: Final = 2.5  # s: a reset may be 1 s old, and then wait 1 s for base's disk
_ONE_WISH: Final = 1.0  # s; a page says each stop in two ways, and again until it is shown


class Stops:
    """Times are monotonic, s."""

    def __init__(
        self,
        engage: Callable[[str, Callable[[EStopAnswer], bool | str], bool], Request],
        reset: Callable[[EStopReset], Request],
        log: Callable[[str], object],
        *,
        is_open: bool,
    ) -> None:
        """`engage` begins to ask base for a stop by that device, or for off; `reset` to ask for a release.

        `is_open`: of the network.
        """
        self._device = ""
        self._stop = EStopRequest(lambda settles, off: engage(self._device, settles, off), is_open=is_open)
        self._ask_reset = reset
        self._release = EStopRelease()
        self._stands_since: float | None = None
        """When a stop was asked for that base's word has answered; None: none that a release could still cross."""
        self._begun = "", -math.inf
        """Who has asked for the stop that base was asked for last, and when: who releases it was shown that one."""
        self._confirmed_at = -math.inf
        self._log = log

    @property
    def asked(self) -> bool:
        """Whether a stop was asked for that base has not confirmed."""
        return self._stop.asked

    @property
    def outcome(self) -> Trouble:
        """Return what became of a stop or a release that was asked for. NO_TROUBLE: nothing is open."""
        return self._stop.outcome if self.asked else self._release.outcome or self._stop.refused_off

    def stop(self, device: str, now: float, *, off: bool = False) -> None:
        """Somebody asks for the emergency stop; `off`: and that it is off."""
        self._device = device
        self._release.withdraw()  # who wants a stop wants no release any more
        self._log(f"{device} asks for the emergency stop")
        if not self._engaged(now) or (off and not self._is_off_answered(now)):
            self._stop.engage(off=off)
            self._begun = device, now
        elif self._begun[0] != device or now - self._begun[1] > _ONE_WISH:
            self._stands_since = now

    def confirmed(self, now: float) -> EStop | None:
        """Return base's newest word if a stop stands, and base has said or confirmed that in this very turn."""
        if self.asked or not self._engaged(now):
            return None
        word, heard = max(self._release.states(now), key=lambda state: state[1])
        return word if now in (heard, self._confirmed_at) else None

    def on_estop(self, state: EStop, now: float) -> None:
        """Take what base says of its stop."""
        self._release.on_sample(state, now)
        self._stop.on_sample(state)
        since = self._stands_since
        if state.engaged:
            if since is not None and now - since >= _STANDS:
                self._stands_since = None
            return
        if not self._release.is_asked:
            self._release.outcome = NO_TROUBLE
        if since is not None:
            self._stands_since = None
            what = f"STILL STOPPED: {self._device} asked for STOP meanwhile"
            self._release.outcome = Trouble(what, action="release")
            self._stop.engage()

    def reset(self, device: str, asked: EStopReset, now: float) -> None:
        """Somebody asks for the release of the latch that he was shown: he knows of each stop before."""
        self._log(f"{device} asks for the release of the emergency stop")
        if self.asked:
            self._release.outcome = Trouble(
                "STILL STOPPED: a stop was not confirmed yet", "wait until it is", "release"
            )
            return
        self._stands_since = None
        self._release.ask(self._ask_reset(asked), now)

    def poll(self, now: float) -> bool:
        """Go on asking; whether base has confirmed a stop just now."""
        confirmed = self._stop.poll(now)
        if confirmed:
            self._confirmed_at = now
        if self._release.poll(now):
            self._log(str(self._release.outcome) or "the emergency stop is released")
        return confirmed

    def _is_off_answered(self, now: float) -> bool:
        return bool(self._stop.refused_off) or all(state.off for state, _ in self._release.states(now))

    def _engaged(self, now: float) -> bool:
        states = self._release.states(now)
        return bool(states) and all(state.engaged for state, _ in states)
