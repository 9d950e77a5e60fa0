"""Reports of the base board as samples."""

from typing import Final

from giraff_base.drives.wheels.config import UM_PER_M
from giraff_core.counters import Standstill, restart, signed32
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import WheelsFrame

_COASTS_NS: Final = 1_500_000_000
"""Without power for so long, no wheel turns on by itself."""
_STANDS: Final = 1.0  # s that end a roll
_ROLLS: Final = 0.05  # m
_TELLS_NS: Final = 10_000_000_000
"""The notice stays for so long after the last moment of a roll, so that it does not flap."""
_ROLLING: Final = Trouble("the wheels turn without power: a slope, or somebody pushes", "park it on a flat floor")


class WheelReports:
    """What the wheels do, as the board measures it."""

    def __init__(self, ticks_per_metre: float) -> None:
        self._roll_ticks = _ROLLS * ticks_per_metre
        self.forget()

    @property
    def at_rest(self) -> bool:
        """Whether both wheels stand still, with no power on them. So it is where there is no report."""
        return self._standstill is None or (self._standstill.is_rest and not self._is_powered)

    def forget(self) -> None:
        self._standstill: Standstill | None = None  # None: there is no report
        self._is_powered = False
        self._powered_ns: int | None = None  # when a motor had power last, or the first report came
        self._roll_from: Wheels | None = None
        self._rolled_ns: int | None = None  # when the wheels were seen to turn without power last
        self.warning = NO_TROUBLE
        """Says that the wheels turn without power. It stops nothing."""

    def on_report(self, report: WheelsFrame, tick: RobotTime) -> Wheels:
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
        self._standstill.on_wheels(sample)
        self._watch(sample, self._standstill)
        return sample

    def _watch(self, sample: Wheels, standstill: Standstill) -> None:
        """Notice a way of more than _ROLLS that no motor has made."""
        now_ns, start = sample.tick.robot_ns, self._roll_from
        if self._is_powered or self._powered_ns is None:
            self._powered_ns = now_ns
        coasts = now_ns - self._powered_ns < _COASTS_NS
        if start is None or restart(start, sample) or coasts or standstill.seconds >= _STANDS:
            start = self._roll_from = sample
        left, right = sample.left_ticks - start.left_ticks, sample.right_ticks - start.right_ticks
        if max(abs(signed32(left)), abs(signed32(right))) > self._roll_ticks:
            self._rolled_ns = now_ns
        tells = self._rolled_ns is not None and now_ns - self._rolled_ns < _TELLS_NS
        self.warning = _ROLLING if tells else NO_TROUBLE
