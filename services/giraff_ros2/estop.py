"""The emergency stop as a service of ROS. There is no release from ROS: who releases it must see the robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from giraff_core.estop.request import EStopRequest, Request
from giraff_core.io import IO
from giraff_ros2.port import Call
from giraff_schemas.actions import ROS
from giraff_schemas.messages import EStop
from giraff_schemas.requests import EStopAnswer, EStopEngage
from giraff_schemas.topics import ESTOP_ENGAGE
from giraff_schemas.trouble import Trouble

_ANSWERS_WITHIN: Final = 3.0
"""s after which a call is answered that base has not confirmed. The stop goes on being asked for."""
_MOST: Final = 16  # calls that wait


class StopCalls:
    """Calls of `~/estop`: all that wait are one stop. Times are monotonic, s."""

    def __init__(self, io: IO, by: str) -> None:
        """`by`: who asks, for people."""

        def engage(settles: Callable[[EStopAnswer], bool | str], off: bool) -> Request:
            return io.ask(ESTOP_ENGAGE, EStopEngage(by=by, reason=Trouble("service estop of ROS"), off=off), settles)

        self._request = EStopRequest(engage, is_open=io.is_open)
        self._calls: list[tuple[Call, float]] = []
        self._told: bool | None = None
        self._newest: EStop | None = None

    @property
    def asked(self) -> bool:
        """Tell whether a stop was asked for that base has not confirmed."""
        return self._request.asked

    def on_call(self, call: Call, now: float) -> None:
        """Somebody wants a stop. One that stands is asked for once more: its release may be on its way."""
        self._request.engage()
        if len(self._calls) < _MOST:
            self._calls.append((call, now))
        else:
            call.answer(False, f"{_MOST} calls wait for base's word already")

    def on_estop(self, sample: EStop) -> None:
        """Take what base says of its stop."""
        self._newest = sample
        self._request.on_sample(sample)

    def poll(self, now: float) -> None:
        """Go on asking, and answer calls."""
        confirmed = self._request.poll(now)
        for call, at in self._calls:
            if confirmed or now - at >= _ANSWERS_WITHIN:
                call.answer(confirmed, self._request.outcome.line(ROS))
        self._calls = [(call, at) for call, at in self._calls if not confirmed and now - at < _ANSWERS_WITHIN]

    def news(self) -> bool | None:
        """Return whether the stop is engaged where that has changed since the last call; None: it has not."""
        if self._newest is None or self._newest.engaged == self._told:
            return None
        self._told = self._newest.engaged
        return self._told
