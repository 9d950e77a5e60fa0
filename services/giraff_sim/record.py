"""The black box: what the motors were given, by the millisecond, and what the base board says about it."""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping
from itertools import pairwise
from typing import Final

import msgspec

from giraff_schemas.framing import Decoder
from giraff_schemas.wire import Frame
from giraff_sim.world.body import BoardReport

WINDOW_US: Final = 100_000_000  # kept; two minutes after a start the record has stopped growing
_FORGET_EVERY: Final = 1024  # entries


class MotorWindow(msgspec.Struct, frozen=True, kw_only=True):
    """A window of the record. Times are simulated us; None: never in the window.

    A frame counts as accepted when the telemetry says so: up to 10 ms and a frame's time on the wire later.
    """

    since_us: int
    until_us: int
    first_driven_us: int | None
    last_driven_us: int | None
    """End of the last millisecond in which a motor had any duty at all."""
    driven_ms: int
    """Milliseconds with any duty."""
    peak_counts: int
    """Largest duty of either motor, of 255."""
    accepted: int
    refused: int
    first_accepted_us: int | None
    last_accepted_us: int | None
    longest_accept_gap_us: int
    """Between two telemetry frames that told of accepted ones, within the window."""
    longest_driven_unasked_us: int
    """Longest time a motor had duty after the last accepted frame was told of."""
    telemetry: int
    """Telemetry frames in the window."""


class _Drive(msgspec.Struct):
    """A run of milliseconds with the same peak."""

    first_us: int  # end of the run's first millisecond
    last_us: int
    peak: int


class _FrameCount(msgspec.Struct):
    now_us: int
    accepted: int  # since the frame before
    refused: int


class Record:
    """Keeps the last WINDOW_US."""

    def __init__(self, report: type[BoardReport], frames: Mapping[int, type[Frame]]) -> None:
        """`report`: the base board's; `frames`: all of its line."""
        self._report = report
        self.telemetry: BoardReport | None = None
        """The newest frame of the base board."""
        self._drives: list[_Drive] = []
        self._told: list[_FrameCount] = []
        self._decoder = Decoder(frames)

    def note_drive(self, now_us: int, peak_counts: int, lasted_us: int = 1000) -> None:
        """The largest duty of either motor in the milliseconds that end now."""
        if self._drives and self._drives[-1].peak == peak_counts:
            self._drives[-1].last_us = now_us
        else:
            self._drives.append(_Drive(now_us - lasted_us + 1000, now_us, peak_counts))
            if len(self._drives) % _FORGET_EVERY == 0:
                del self._drives[: bisect_left(self._drives, now_us - WINDOW_US, key=_drive_ends)]

    def note_sent(self, now_us: int, data: bytes) -> None:
        """What the base board has sent in the millisecond that ends now."""
        for frame in self._decoder.feed(data):
            if not isinstance(frame, self._report):
                continue
            before = self.telemetry
            accepted, refused = frame.accepted, frame.refused
            if before is not None and before.boot_id == frame.boot_id:
                accepted, refused = (accepted - before.accepted) & 0xFFFF, (refused - before.refused) & 0xFFFF
            self.telemetry = frame
            self._told.append(_FrameCount(now_us, accepted, refused))
            if len(self._told) % _FORGET_EVERY == 0:
                del self._told[: bisect_left(self._told, now_us - WINDOW_US, key=_told_at)]

    def window(self, since_us: int, until_us: int) -> MotorWindow:
        """What happened after `since_us` and not after `until_us`."""
        first_ms, last_ms = since_us // 1000 + 1, until_us // 1000  # ends of the window's milliseconds
        runs = self._drives[
            bisect_right(self._drives, since_us, key=_drive_ends) : bisect_right(
                self._drives, until_us, key=_drive_begins
            )
        ]
        driven = [(max(run.first_us, first_ms * 1000), min(run.last_us, last_ms * 1000)) for run in runs if run.peak]
        told = self._told[
            bisect_right(self._told, since_us, key=_told_at) : bisect_right(self._told, until_us, key=_told_at)
        ]
        accepted_us = [one.now_us for one in told if one.accepted]
        return MotorWindow(
            since_us=since_us,
            until_us=until_us,
            first_driven_us=driven[0][0] if driven else None,
            last_driven_us=driven[-1][1] if driven else None,
            driven_ms=sum((last - first) // 1000 + 1 for first, last in driven),
            peak_counts=max((run.peak for run in runs), default=0),
            accepted=sum(one.accepted for one in told),
            refused=sum(one.refused for one in told),
            first_accepted_us=accepted_us[0] if accepted_us else None,
            last_accepted_us=accepted_us[-1] if accepted_us else None,
            longest_accept_gap_us=max((later - earlier for earlier, later in pairwise(accepted_us)), default=0),
            longest_driven_unasked_us=self._longest_unasked(driven, since_us),
            telemetry=len(told),
        )

    def _longest_unasked(self, driven: list[tuple[int, int]], since_us: int) -> int:
        asked = [one.now_us for one in self._told if one.accepted]
        longest = 0
        for first, last in driven:
            within = asked[bisect_right(asked, first) : bisect_right(asked, last)]
            for moment in (*within, last):
                before = bisect_left(asked, moment)
                longest = max(longest, moment - (asked[before - 1] if before else since_us))
        return longest


def _drive_begins(run: _Drive) -> int:
    return run.first_us


def _drive_ends(run: _Drive) -> int:
    return run.last_us


def _told_at(one: _FrameCount) -> int:
    return one.now_us
