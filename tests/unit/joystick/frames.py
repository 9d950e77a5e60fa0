"""The robot, the settings and the frames of these tests."""

from pathlib import Path

import msgspec

from giraff_core.robot import RobotConfig
from giraff_joystick.config import JoystickConfig
from giraff_node.config.robot_file import load
from giraff_schemas.wire import TiltFrame, TiltStatus

ROBOT = msgspec.structs.replace(
    load("robot", RobotConfig, {"GIRAFF_CONFIG": str(Path(__file__).parents[3] / "deploy" / "robot.toml")}),
    track_width=0.47,
    max_wheel_speed=0.6,
    max_angular_speed=1.57,
)
ANGLE = JoystickConfig()
SOURCE = JoystickConfig(curve="source")

EPOCH = 77


def tilt_frame(
    x: float = 0.0,
    y: float = 0.0,
    z: float = 9.81,
    *,
    seq: int = 0,
    status: int = TiltStatus.RUNNING,
    epoch: int = EPOCH,
    robot_ns: int = 1_000,
    boot_id: int = 1,
    sys_error: int = 0,
    button: int = 0,
) -> TiltFrame:
    """A frame of the joystick board; x, y, z in m/s²."""
    return TiltFrame(
        seq=seq,
        board_us=0,
        boot_id=boot_id,
        tick_epoch=epoch,
        tick_robot_ns=robot_ns,
        x=round(x * 100),
        y=round(y * 100),
        z=round(z * 100),
        status=status,
        sys_status=0,
        sys_error=sys_error,
        button=button,
        line_errors=0,
    )
