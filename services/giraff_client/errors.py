"""Why the robot does not do what a script asks. Each message names the cause and the way out."""

from giraff_core.motion.result import MotionResult
from giraff_schemas.actions import SCRIPT
from giraff_schemas.messages import Direction, DirectionLimit, EStop
from giraff_schemas.text import printable_lines


class RobotError(Exception):
    """Whatever stands between a script and its robot. A traceback shows the message in a terminal."""

    def __init__(self, text: str) -> None:
        super().__init__(printable_lines(text))


class NoRobotError(RobotError):
    """No robot is heard, or not any more, or it cannot be told which is meant."""


class LostRobotError(NoRobotError):
    """The robot was there, and its clock is not heard any more."""


class SilentError(RobotError):
    """The robot is there, and what the script wants to read is not."""


class RefusedError(RobotError):
    """Another operator drives, or this one's lease has ended."""

    def __init__(self, holder: str, reason: str) -> None:
        super().__init__(reason)
        self.holder = holder
        """Name of the operator that drives; empty: nobody does."""


class TakenError(RefusedError):
    """Another operator drives: it held the robot before, or has taken it. `holder` is its name."""


class NotArmedError(RobotError):
    """The robot has the script's command and does not obey it: something has disarmed it."""


class EmergencyStopError(RobotError):
    """The emergency stop is engaged."""

    def __init__(self, state: EStop) -> None:
        self.by = state.by
        self.reason = state.reason.line(SCRIPT)
        super().__init__(f"emergency stop, engaged by {self.by}: {self.reason}")


class BlockedError(RobotError):
    """The guard lets nothing through in a direction that a script asks for."""

    def __init__(self, direction: Direction, verdict: DirectionLimit) -> None:
        super().__init__(f"{direction} blocked: {verdict.reason}")
        self.direction = direction
        self.sensor = verdict.sensor
        """Name of the sensor that blocks; empty: none does."""
        self.reason = verdict.reason.what
        self.remedy = verdict.reason.remedy
        """What the script can do instead; empty: nothing is known."""


class MotionError(RobotError):
    """A motion by metres and radians, or a route, has not arrived, or was not begun."""

    def __init__(self, result: MotionResult) -> None:
        came = f"; it came {result.way}" if result.begun else ""
        super().__init__(f"{result.outcome.replace('_', ' ')}: {result.reason}{came}")
        self.result = result
        """How it ended, how far it came, and why."""


class MotionBlockedError(MotionError):
    """A motion has ended before an obstacle, or before what a sensor that is at fault does not see."""

    @property
    def sensor(self) -> str:
        """Name of the sensor that blocks; empty: none does."""
        return self.result.sensor


class FrameError(RobotError):
    """It cannot be told where a frame is in another."""


class UnknownFrameError(FrameError):
    """Nobody has told of such a frame. The message names those that are known."""


class UnconnectedError(FrameError):
    """Both frames are known, and nothing joins them."""


class UnlocalizedError(FrameError):
    """It is not known where the robot is on the map. The message says why, and the way out."""


class PastError(FrameError):
    """The moment is before what is remembered, or of an earlier start of base."""


class FutureError(FrameError):
    """Odometry has not been heard of that moment yet. The message says how far ahead it is."""


class GapError(FrameError):
    """At that moment odometry was set, began anew or was not heard: nobody can tell where the robot was."""
