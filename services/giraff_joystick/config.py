"""The table `[joystick]` of the robot file."""

from typing import Annotated

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.parts import ANGLE
from giraff_core.tilt.curves import Curve
from giraff_core.tuning import Tuning
from giraff_schemas.topics import require_chunk


class JoystickConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the joystick board is, and what a tilt means."""

    port: Annotated[str, Tuning.READ_ONLY] = "/dev/giraff-joystick"
    """Path of the board's serial port."""
    operator: Annotated[str, Tuning.READ_ONLY] = "joystick"
    """Name under which this operator's commands are published: `cmd_vel/<operator>`."""
    asks_from_start: Annotated[bool, Tuning.READ_ONLY] = True
    """Ask for the lease from the start; else only once the joystick is tilted, or its button pressed."""
    curve: Annotated[Curve, Tuning.READ_ONLY] = "angle"
    """`angle`: speed grows with the angle between `dead_zone_deg` and `full_tilt_deg`; yaw is capped at the
    robot's `max_angular_speed`. `source`: asks for the published curve, exactly: speed grows with the acceleration from
    4.5 to 9.5 m/s², which is 27 to 76 degrees; yaw is limited by the wheels alone. The robot drives it exactly up to
    its `max_angular_speed`: guard slows what turns faster, in the same curve, whoever asks."""
    dead_zone_deg: Annotated[float, Tuning.RAISE_ONLY] = 8.0
    """Degrees from the zero within which nothing moves; of the curve `angle`."""
    full_tilt_deg: Annotated[float, Tuning.RAISE_ONLY] = 35.0
    """Degrees from the zero at which full speed is reached; of the curve `angle`."""
    stillness: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.001, 2.0, "m/s²")] = 0.045
    """m/s², rms over 1 s: what moves less while it asks to drive has been laid down. Twice the sensor's own noise
    (0.021), and below the tremor of most hands (0.07). A steadier hand needs less."""

    mount_roll: Annotated[float, Tuning.READ_ONLY, ANGLE] = 0.0
    """rad. How the sensor sits in the joystick, about the axes of `tilt`: first roll, then pitch, then yaw (REP-103).
    `giraff calibrate joystick` measures the three."""
    mount_pitch: Annotated[float, Tuning.READ_ONLY, ANGLE] = 0.0
    """rad, about the axis y of `tilt`."""
    mount_yaw: Annotated[float, Tuning.READ_ONLY, ANGLE] = 0.0
    """rad, counter-clockwise positive as seen from above."""

    def __post_init__(self) -> None:
        if not self.port:
            raise ValueError("port is empty: give the path of the joystick board's serial port")
        require_chunk(self.operator)
        check_bounds(self)
        if not 0.0 < self.dead_zone_deg < self.full_tilt_deg <= 90.0:
            raise ValueError(
                f"dead_zone_deg is {self.dead_zone_deg} and full_tilt_deg {self.full_tilt_deg}: "
                "they must grow in that order between 0 and 90"
            )
