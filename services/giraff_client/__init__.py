"""The robot in a script of one's own: `from giraff_client import Robot`. See docs/client.md."""

from giraff_client.camera import CameraPicture
from giraff_client.errors import (
    BlockedError,
    EmergencyStopError,
    FrameError,
    FutureError,
    GapError,
    LostRobotError,
    MotionBlockedError,
    MotionError,
    NoRobotError,
    NotArmedError,
    PastError,
    RefusedError,
    RobotError,
    SilentError,
    TakenError,
    UnconnectedError,
    UnknownFrameError,
    UnlocalizedError,
)
from giraff_client.robot import Robot
from giraff_core.motion.result import MotionResult
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import Range
from giraff_schemas.motion import Arc, GoTo, Move, Turn

__all__ = [
    "Arc",
    "BlockedError",
    "Bump",
    "CameraPicture",
    "EmergencyStopError",
    "FrameError",
    "FutureError",
    "GapError",
    "GoTo",
    "LostRobotError",
    "MotionBlockedError",
    "MotionError",
    "MotionResult",
    "Move",
    "NoRobotError",
    "NotArmedError",
    "PastError",
    "Range",
    "RefusedError",
    "Robot",
    "RobotError",
    "SilentError",
    "TakenError",
    "Turn",
    "UnconnectedError",
    "UnknownFrameError",
    "UnlocalizedError",
]
