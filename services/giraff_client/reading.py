"""What a script reads of the robot: each sensor that it has, and each way that it may go. No I/O and no clock."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Final

import msgspec

from giraff_client.errors import BlockedError
from giraff_core.latest import is_fresh
from giraff_core.senses import Ultrasonic
from giraff_schemas.checks import require_sendable
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import BaseState, Battery, EStop, GuardState, Range, Sample
from giraff_schemas.motion import MotionState
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, MOTION, POSE, RANGE, SampleT, Topic
from giraff_schemas.trouble import Trouble

_PREFIX: Final = RANGE.key.removesuffix("*")

Heard = Mapping[str, tuple[Sample, float]]
"""By key below the robot's name: the newest sample, and when it was heard, s of a monotonic clock."""


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


def has_heard_each_sensor(heard: Heard) -> bool:
    """Whether each sensor of the robot was heard. The guard tells which there are: those of the robot file."""
    state = heard.get(GUARD.key)
    return state is not None and all(_PREFIX + sensor in heard for sensor in _sensors(heard))


def ranges_of(heard: Heard, now: float) -> dict[str, Range]:
    """By sensor, of all that the guard names and all that were heard: its newest reading, or why there is none."""
    return {sensor: _range_of(sensor, heard, now) for sensor in _sensors(heard)}


def blockage(state: GuardState, linear_x: float, angular_z: float) -> BlockedError | None:
    """What the guard lets nothing through of; None: something of each direction that is asked for."""
    if linear_x and (verdict := state.forward if linear_x > 0.0 else state.backward).clearance == "blocked":
        return BlockedError("forward" if linear_x > 0.0 else "backward", verdict)
    if angular_z and (verdict := state.turn_left if angular_z > 0.0 else state.turn_right).clearance == "blocked":
        return BlockedError("turn_left" if angular_z > 0.0 else "turn_right", verdict)
    return None


def require_finite(call: str, units: str, *values: object) -> None:
    """Raises ValueError for what is no number that can be meant."""
    try:
        require_sendable(values)
        is_number = all(isinstance(value, (int, float)) for value in values)
    except ValueError:
        is_number = False
    if not is_number:
        raise ValueError(f"{call}({', '.join(map(str, values))}): all must be finite numbers, {units}")


def _sensors(heard: Heard) -> list[str]:
    state, _ = heard.get(GUARD.key, (None, 0.0))
    told = state.of_type(Ultrasonic.type_name()) if isinstance(state, GuardState) else []
    return sorted({*told, *(key.removeprefix(_PREFIX) for key in heard if key.startswith(_PREFIX))})


def _range_of(sensor: str, heard: Heard, now: float) -> Range:
    key = _PREFIX + sensor
    reading, at = heard.get(key, (None, 0.0))
    if not isinstance(reading, Range):
        never = Trouble(f"{key} was never heard", "check that giraff_ranger runs, and this sensor's wires")
        return Range(sensor=sensor, state="fault", range=None, echo_us=0, reason=never, tick=None)
    if is_fresh(RANGE, now - at):
        return reading
    silent = Trouble(f"{key} is silent for {now - at:.1f} s", "check giraff_ranger and its board")
    return msgspec.structs.replace(reading, state="fault", range=None, echo_us=0, reason=silent)
