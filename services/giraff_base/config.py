"""Table `[base]` of the robot file."""

from typing import Annotated, Final, get_args

import msgspec

from giraff_base.drives.balancer.config import BalancerConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning

DriveConfig = WheelsConfig | BalancerConfig
"""Of each kind of drive: a union, told apart by `type`."""
KINDS: Final[tuple[type[DriveConfig], ...]] = get_args(DriveConfig)


class BaseConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    port: Annotated[str, Tuning.READ_ONLY]
    """Serial port of the base board; of one that is a process, the port which that makes."""
    drive: Annotated[DriveConfig, Tuning.READ_ONLY]
    """The table `[base.drive]`: what moves the robot."""
    operator_budget: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.05, 2.0, "s")] = 0.4
    """s; largest age of the operator's tick."""
    guard_budget: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.02, 2.0, "s")] = 0.2
    """s; largest age of the guard's tick."""
    range_budget: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.05, 2.0, "s")] = 0.4
    """s; largest age of the oldest range that the motion relies on."""
    reset_budget: Annotated[float, Tuning.READ_ONLY, Bounds(0.1, 5.0, "s")] = 1.0
    """s; largest age of the tick in a reset of the emergency stop: some attempts over a bad link, and far less than
    the 8 s after which TCP has been seen to hand over what was queued."""
    arm_time: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.05, 10.0, "s")] = 0.2
    """s that a neutral hand must be held to arm the robot."""
    neutral_gap: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.01, 1.0, "s")] = 0.1
    """s; longest gap within that time: some lost commands of 50 a second, not a hand that was elsewhere."""
    disarm_time: Annotated[float, Tuning.READ_ONLY, Bounds(0.1, 10.0, "s")] = 1.0
    """s of stale command or range, or of a silent board, after which the robot must be armed again."""
    guard_silence: Annotated[float, Tuning.READ_ONLY, Bounds(0.1, 10.0, "s")] = 0.5
    """s of silence after which another guard may take the place of the one in charge."""
    linear_acceleration: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.01, 10.0, "m/s²")] = 0.6
    """m/s², of starts only: a stop is immediate."""
    angular_acceleration: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.05, 100.0, "rad/s²")] = 2.5
    """rad/s², of starts only."""
    battery_low: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.0, 100.0, "V")] = 22.0
    """V; held below it for 5 s the robot warns and drives at half speed. 0: never. 1.1 V for each of 20 NiMH cells.
    Like the next, only where `battery_volts_per_count` is known."""
    battery_cutoff: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.0, 100.0, "V")] = 20.0
    """V; held below it for 5 s the robot stops, and drives again above `battery_low`. 0: never. 1 V a cell."""

    def __post_init__(self) -> None:
        check_bounds(self)
        board = self.drive.board_type
        if board.is_process and self.port.startswith("/dev/") and not self.port.startswith("/dev/pts/"):
            raise ValueError(
                f"port is {self.port}: only the process {board.unit} opens the controller's port; "
                "it must be the one that the process makes, /run/giraff-board/port"
            )
        if self.battery_low and self.battery_cutoff > self.battery_low:
            raise ValueError(f"battery_cutoff is {self.battery_cutoff}: it must not be above battery_low")
        if 0.0 < self.battery_cutoff <= self.drive.battery_minimum:
            raise ValueError(
                f"battery_cutoff is {self.battery_cutoff:g} V: it must be above drive.battery_minimum, "
                f"{self.drive.battery_minimum:g} V, at which the robot sits down, or it never counts"
            )
