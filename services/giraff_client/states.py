"""What a script reads of the robot in one word: the newest of each kind."""

from __future__ import annotations

from abc import ABC, abstractmethod

from giraff_schemas.localization import MapPose
from giraff_schemas.messages import BaseState, Battery, EStop, GuardState
from giraff_schemas.motion import MotionState
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, MOTION, POSE, SampleT, Topic


class States(ABC):
    """What was not said of late is not returned: it raises SilentError, or LostRobotError."""

    def battery(self) -> Battery:
        """Voltage, V, heard within the last one and a half seconds. Raises SilentError, LostRobotError."""
        return self._fresh(BATTERY, "check that giraff_base runs, and [base.drive] battery_volts_per_count is not 0")

    def estop(self) -> EStop:
        """Whether the emergency stop is engaged, by whom and why, heard within the last one and a half seconds.

        Raises SilentError, LostRobotError.
        """
        return self._fresh(ESTOP, "check that giraff_base runs")

    def base(self) -> BaseState:
        """Whether base drives, and if not, why. Raises SilentError, LostRobotError."""
        return self._fresh(BASE, "check that giraff_base runs")

    def guard(self) -> GuardState:
        """What the guard allows in each direction, and why not more. Raises SilentError, LostRobotError."""
        return self._fresh(GUARD, "check that giraff_guard runs on base's machine")

    def motion(self) -> MotionState:
        """How the newest motion by metres and radians goes on or has ended. Raises SilentError, LostRobotError."""
        return self._fresh(MOTION, "check that giraff_motion runs")

    def map_pose(self) -> MapPose:
        """Return where the robot is on the map, m and rad, heard within the last second: look at its `state` first.

        It is known while that is `localized`. While it is `told`, somebody has said so, and nothing speaks against it.
        Otherwise `x`, `y` and `yaw` are the best guess or the last one, `reason` says why, and `candidates` where it
        may be. `standard_deviations` says how sure each of them is. Raises SilentError, LostRobotError.
        """
        return self._fresh(POSE, "start giraff_localization, on any machine of the robot's network")

    @abstractmethod
    def _fresh(self, topic: Topic[SampleT], remedy: str) -> SampleT:
        """The newest, unless it says nothing of now. Raises SilentError with the way out, LostRobotError."""
