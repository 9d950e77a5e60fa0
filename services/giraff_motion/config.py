"""The table `[motion]` of the robot file."""

from typing import Annotated

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning


class MotionConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot moves where nobody asks for another way. What bears on safety is the guard's."""

    speed: Annotated[float, Tuning.FREE, Bounds(0.02, 5.0, "m/s")] = 0.3
    """m/s at most, of a motion that names no other."""
    turn_speed: Annotated[float, Tuning.FREE, Bounds(0.05, 20.0, "rad/s")] = 0.6
    """rad/s at most on the spot, of a motion that names no other."""
    least_speed: Annotated[float, Tuning.FREE, Bounds(0.01, 1.0, "m/s")] = 0.06
    """m/s, by which it comes to its end; more than `[guard] min_speed`."""
    least_turn_speed: Annotated[float, Tuning.FREE, Bounds(0.02, 5.0, "rad/s")] = 0.2
    """rad/s; the same on the spot."""
    deceleration: Annotated[float, Tuning.FREE, Bounds(0.05, 5.0, "m/s²")] = 0.4
    """m/s² by which it slows down before its end."""
    turn_deceleration: Annotated[float, Tuning.FREE, Bounds(0.1, 20.0, "rad/s²")] = 1.0
    """rad/s²; the same on the spot."""
    position_tolerance: Annotated[float, Tuning.FREE, Bounds(0.001, 0.5, "m")] = 0.005
    """m along the way, by which the end of a piece may be missed: a robot that rests farther off is moved again."""
    heading_tolerance: Annotated[float, Tuning.FREE, Bounds(0.001, 0.5, "rad")] = 0.005
    """rad; the same of a turn."""
    rest_speed: Annotated[float, Tuning.FREE, Bounds(0.001, 0.5, "m/s")] = 0.005
    """m/s at most, as odometry has it, of a robot that stands: a robot that balances sways."""
    rest_turn_speed: Annotated[float, Tuning.FREE, Bounds(0.001, 2.0, "rad/s")] = 0.005
    """rad/s; the same of its turning."""
    rest_time: Annotated[float, Tuning.FREE, Bounds(0.1, 1.4, "s")] = 0.2
    """s for which it has stood before it is judged where it is: a robot that balances rolls back first."""
    patience: Annotated[float, Tuning.FREE, Bounds(0.1, 60.0, "s")] = 1.0
    """s for which its way may be blocked before it ends."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.least_speed > self.speed or self.least_turn_speed > self.turn_speed:
            raise ValueError(
                f"least_speed is {self.least_speed:g} m/s and speed {self.speed:g} m/s, least_turn_speed "
                f"{self.least_turn_speed:g} rad/s and turn_speed {self.turn_speed:g} rad/s: the least must not be more"
            )
