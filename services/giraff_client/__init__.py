"""The robot in a script of one's own: `from giraff_client import Robot`. See docs/client.md."""

from giraff_client.errors import (
    BlockedError,
    EmergencyStopError,
    LostRobotError,
    NoRobotError,
    NotArmedError,
    RefusedError,
    RobotError,
    SilentError,
    TakenError,
)
from giraff_client.robot import Robot

__all__ = [
    "BlockedError",
    "EmergencyStopError",
    "LostRobotError",
    "NoRobotError",
    "NotArmedError",
    "RefusedError",
    "Robot",
    "RobotError",
    "SilentError",
    "TakenError",
]
