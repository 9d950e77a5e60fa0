"""Reports of the base board as samples."""

from __future__ import annotations

from giraff_base.drives.wheels.config import UM_PER_M
from giraff_core.kinematics.standstill import Standstill
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.wire import WheelsFrame


class WheelReports:
    """What the wheels do, as the board measures it."""

    def __init__(self) -> None:
        self._standstill: Standstill | None = None  # None: there is no report
        self._is_powered = False

    @property
    def at_rest(self) -> bool:
        """Whether both wheels stand still, with no power on them. So it is where there is no report."""
        return self._standstill is None or (self._standstill.is_rest and not self._is_powered)

    def forget(self) -> None:
        self._standstill = None

    def take(self, report: WheelsFrame, tick: RobotTime) -> Wheels:
        """The sample of one report that was read at `tick`."""
        self._is_powered = bool(report.left_pwm_counts or report.right_pwm_counts)
        sample = Wheels(
            left_ticks=report.left_ticks,
            right_ticks=report.right_ticks,
            left_velocity=report.left_um_s / UM_PER_M,
            right_velocity=report.right_um_s / UM_PER_M,
            left_pwm_counts=report.left_pwm_counts,
            right_pwm_counts=report.right_pwm_counts,
            board_us=report.board_us,
            boot_id=report.boot_id,
            tick=tick,
        )
        if self._standstill is None:
            self._standstill = Standstill()
        self._standstill.hear(sample)
        return sample
