"""The robot in a script of one's own: `from giraff_client import Robot`. See docs/client.md."""

from giraff_client.errors import (
    EmergencyStopError,
    NoRobotError,
    NotArmedError,
    RefusedError,
    RobotError,
    SilentError,
)
from giraff_client.robot import Robot

__all__ = [
    "EmergencyStopError",
    "NoRobotError",
    "NotArmedError",
    "RefusedError",
    "Robot",
    "RobotError",
    "SilentError",
]
