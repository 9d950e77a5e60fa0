"""Reports of the base board as samples."""

from __future__ import annotations

from collections import deque

from giraff_core.counters import signed32
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.wire import WheelsFrame

_WINDOW_US = 50_000  # one tick is 0.5 mm: over 10 ms alone a speed would come in steps of 0.05 m/s
_LONGEST_GAP_US = 200_000


class WheelReports:
    """Speeds from the board's own time, over the last 50 ms of reports of one boot."""

    def __init__(self, robot: RobotConfig) -> None:
        self._metres_per_tick = 1.0 / robot.ticks_per_metre
        self._reports: deque[WheelsFrame] = deque()
        self.left_velocity = 0.0
        self.right_velocity = 0.0

    @property
    def at_rest(self) -> bool:
        """Whether both wheels stood still through the whole window, with no power on them."""
        if not self._reports:
            return True
        newest = self._reports[-1]
        powered = newest.left_pwm_counts or newest.right_pwm_counts
        return not powered and self.left_velocity == 0.0 and self.right_velocity == 0.0

    def forget(self) -> None:
        self._reports.clear()
        self.left_velocity = self.right_velocity = 0.0

    def take(self, report: WheelsFrame, tick: RobotTime) -> Wheels:
        """The sample of one report that was read at `tick`."""
        if self._reports:
            newest = self._reports[-1]
            gap_us = (report.board_us - newest.board_us) & 0xFFFFFFFF
            if report.boot_id != newest.boot_id or report.session != newest.session or gap_us > _LONGEST_GAP_US:
                self.forget()
        self._reports.append(report)
        while len(self._reports) > 2 and (report.board_us - self._reports[1].board_us) & 0xFFFFFFFF >= _WINDOW_US:
            self._reports.popleft()
        oldest = self._reports[0]
        seconds = ((report.board_us - oldest.board_us) & 0xFFFFFFFF) * 1e-6
        if seconds > 0.0:
            scale = self._metres_per_tick / seconds
            self.left_velocity = signed32(report.left_ticks - oldest.left_ticks) * scale
            self.right_velocity = signed32(report.right_ticks - oldest.right_ticks) * scale
        return Wheels(
            left_ticks=report.left_ticks,
            right_ticks=report.right_ticks,
            left_velocity=self.left_velocity,
            right_velocity=self.right_velocity,
            left_pwm_counts=report.left_pwm_counts,
            right_pwm_counts=report.right_pwm_counts,
            board_us=report.board_us,
            boot_id=report.boot_id,
            tick=tick,
        )
