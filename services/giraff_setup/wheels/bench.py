"""The base board on the bench: drives its motors straight from its serial port, with the same proofs as base.

Each frame answers a report and echoes its time, so that the board stops by itself 0.3 s after this process does.
"""

import random
import select
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Final, NamedTuple

from giraff_base.drives.wheels.setup import WheelsCommands, by_levels
from giraff_core.counters import signed32
from giraff_node.boards.board_link import BoardLink
from giraff_schemas.actions import RESET_COMMAND
from giraff_schemas.boards import BoardType
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import DriveState, Frame, Latch, Refusal, WheelsFrame, Wiring
from giraff_setup.wheels.wiring import Counted, Side

_SILENCE: Final = 3.0  # s; a Mega that is reset as its port is opened takes 1 to 2 s
_STEP_WITHIN: Final = 2.0  # s for what the board does at once
_WAIT: Final = 0.05  # s
_REST_US: Final = 200_000  # without a tick: at rest
_COAST_WITHIN: Final = 5.0  # s


RESTLESS: Final = Trouble(
    "counts on while the wheel stands",
    "check the wire and the plug of each of its sensors, and that they are firm; keep hands off the wheel",
)
"""Said of an encoder."""


class BenchError(Exception):
    """The board cannot be driven. The message says why, and the way out."""


class RestlessError(BenchError):
    """Encoders count to and fro though their wheels stand. The motors are at zero."""

    def __init__(self, sides: Sequence[Side], counted: Counted, latch: Latch) -> None:
        """`counted` and `latch`: as `WheelBench.drive` returns them."""
        super().__init__(f"the encoder of the {' and of the '.join(sides)} wheel {RESTLESS}")
        self.sides, self.counted, self.latch = sides, counted, latch


class Levels(NamedTuple):
    """PWM counts of 255, forward positive."""

    left: int
    right: int


ZERO: Final = Levels(0, 0)
Watch = Callable[[Frame], Frame | None]
"""Sees each frame of the board while a wheel is driven, and returns what the board is asked for beside it, if any."""


class WheelBench:
    """Owns the port. Nothing drives between two calls."""

    def __init__(self, port: str, board: BoardType, ticks_per_metre: float) -> None:
        self._port = port
        self._link = BoardLink(port, board)
        self._ticks_per_metre = ticks_per_metre
        self._report: WheelsFrame | None = None
        self._session = 0
        self._frames = WheelsCommands()
        self._watch: Watch | None = None

    def open(self) -> None:
        """Take the port, and hear the board. BenchError when there is none, or it is latched by somebody."""
        report = next(self._reports())
        if report.latch == Latch.ESTOP:
            raise BenchError(
                f"{self._port}: the emergency stop is engaged on the board; start giraff_base, "
                f"`{RESET_COMMAND}`, end giraff_base, and begin again"
            )

    def drive(
        self, wiring: Wiring, levels: Levels, seconds: float, stall_level: int, watch: Watch | None = None
    ) -> tuple[Counted, Latch]:
        """Drive at `levels`; what was counted until the wheels are at rest again, and what ended it early, if so.

        `stall_level`: 255 where nobody knows yet which encoder belongs to which motor: no wheel counts as stuck.
        """
        start = self._configured(wiring, max(map(abs, levels)), stall_level)
        began_us = start.board_us
        latch = Latch.NONE
        try:
            self._watch = watch
            for report in self._reports():
                latch = Latch(report.latch)
                if latch != Latch.NONE or (report.board_us - began_us) & 0xFFFFFFFF >= seconds * 1e6:
                    break
                if report.drive_state != DriveState.ACTIVE:
                    raise BenchError("the board stopped in between, frames came late; end what keeps this machine busy")
                self._send(report, levels)
        finally:
            self._watch = None
            self.stop()
        end, restless = self._at_rest()
        counted = self._counted(start, end)
        if restless:
            raise RestlessError(restless, counted, latch)
        return counted, latch

    def stop(self) -> None:
        """Zero, now."""
        if self._report is not None:
            self._send(self._report, ZERO)

    def close(self) -> None:
        """Zero, and let go of the port."""
        self.stop()
        self._link.close()

    def _configured(self, wiring: Wiring, level_max: int, stall_level: int) -> WheelsFrame:
        """Open a session and its latches; the report of a board that would drive now."""
        self._session = random.randrange(1, 1 << 32)
        settings = by_levels(wiring, level_max, stall_level)

        def configure(report: WheelsFrame) -> None:
            self._link.send(self._frames.configure(report, self._session, settings))

        def release(report: WheelsFrame) -> None:
            self._link.send(self._frames.estop(report, self._session, engage=False))

        self._until(lambda report: report.session == self._session, configure, "takes no configuration")
        self._until(lambda report: report.latch == Latch.NONE, release, "stays latched")
        return self._until(
            lambda report: report.drive_state == DriveState.ACTIVE, self._send_zero, "does not get ready"
        )

    def _until(
        self, holds: Callable[[WheelsFrame], bool], act: Callable[[WheelsFrame], None], trouble: str
    ) -> WheelsFrame:
        """Answer each report with `act` until one `holds`."""
        deadline = time.monotonic() + _STEP_WITHIN
        for report in self._reports():
            if holds(report):
                return report
            if time.monotonic() > deadline:
                break
            act(report)
        refusal = Refusal(self._report.last_refusal).name.lower() if self._report is not None else ""
        raise BenchError(f"{self._port}: the board {trouble} (last refusal: {refusal}); reset it, or reflash it")

    def _at_rest(self) -> tuple[WheelsFrame, list[Side]]:
        """Keep at zero until no tick has come for a while, or long enough to name the encoders that count to and fro.

        BenchError where a wheel itself goes on turning.
        """
        begin = time.monotonic()
        newest: WheelsFrame | None = None
        late = list[WheelsFrame]()
        for report in self._reports():
            self._send_zero(report)
            if newest is None or (report.left_ticks, report.right_ticks) != (newest.left_ticks, newest.right_ticks):
                newest = report
            elif (report.board_us - newest.board_us) & 0xFFFFFFFF >= _REST_US:
                return report, []
            waited = time.monotonic() - begin
            if waited > _COAST_WITHIN / 2.0:
                late.append(report)
            if waited > _COAST_WITHIN:
                break
        ways = [self._counted(late[0], report) for report in late]
        counts: dict[Side, list[int]] = {"left": [way.left for way in ways], "right": [way.right for way in ways]}
        spans: dict[Side, int] = {side: max(each) - min(each) for side, each in counts.items()}
        if max(spans.values()) >= ways[0].fewest:
            raise BenchError(
                "the wheels do not come to rest at zero; keep hands off them, and check the motor drivers and "
                "the encoders' wires"
            )
        return late[-1], [side for side, span in spans.items() if span]

    def _counted(self, start: WheelsFrame, end: WheelsFrame) -> Counted:
        left = signed32(end.left_ticks - start.left_ticks)
        return Counted.at(left, signed32(end.right_ticks - start.right_ticks), self._ticks_per_metre)

    def _reports(self) -> Iterator[WheelsFrame]:
        """The board's newest report, again and again. BenchError when it falls silent, or was reset."""
        heard = time.monotonic()
        while True:
            arrived = self._link.poll(time.monotonic())
            for request in map(self._watch, arrived) if self._watch is not None else ():
                if request is not None:
                    self._link.send(request)
            frames = [frame for frame in arrived if isinstance(frame, WheelsFrame)]
            if frames:
                if self._report is not None and frames[-1].boot_id != self._report.boot_id:
                    raise BenchError(f"{self._port}: the board was reset in between; check its power, and begin again")
                self._report = frames[-1]
                heard = time.monotonic()
                yield self._report
            elif time.monotonic() - heard > _SILENCE:
                raise BenchError(f"{self._link.fault}; giraff_base must not run meanwhile")
            else:
                descriptor = self._link.descriptor()
                select.select([] if descriptor is None else [descriptor], [], [], _WAIT)

    def _send_zero(self, report: WheelsFrame) -> None:
        self._send(report, ZERO)

    def _send(self, report: WheelsFrame, levels: Levels) -> None:
        self._link.send(self._frames.drive(report, levels.left, levels.right))
