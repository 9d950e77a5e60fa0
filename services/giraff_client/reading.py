"""What a script reads of the robot: each sensor that it has, and each way that it may go. No I/O and no clock."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

import msgspec

from giraff_client.errors import BlockedError, NoRobotError, RobotError
from giraff_core.latest import is_fresh
from giraff_core.senses import PUBLISHERS, SENSE_OF, SENSED
from giraff_schemas.checks import require_sendable
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import BaseState, Battery, EStop, GuardState, Range, Sample
from giraff_schemas.motion import MotionState
from giraff_schemas.places import RouteState
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, MOTION, POSE, RANGE, ROUTE, SampleT, Topic, covers
from giraff_schemas.trouble import NO_TROUBLE, Trouble

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

    def route(self) -> RouteState:
        """Return how the newest route goes on or has ended. Raises SilentError, LostRobotError."""
        return self._fresh(ROUTE, "check that giraff_places runs")

    def map_pose(self) -> MapPose:
        """Return where the robot is on the map, m and rad, heard within the last second: look at its `state` first.

        It is known while that is `localized`. While it is `told`, somebody has said so, and nothing speaks against it.
        Otherwise `x`, `y` and `yaw` are the best guess or the last one, `reason` says why, and `candidates` where it
        may be. `standard_deviations` says how sure each of them is. Raises SilentError, LostRobotError.
        """
        return self._fresh(POSE, "start giraff_localization, on any machine of the robot's network")

    def ranges(self) -> dict[str, Range]:
        """By sensor, for each that the robot has, the newest reading, m.

        One that was silent for a second, or was never heard, is a fault: it has a reason and no range. The guard tells
        which sensors there are; without it, those that are heard. The first call waits for them, up to 2 s from the
        begin of the `with`. Raises SilentError where nothing tells of any sensor, LostRobotError.
        """
        readings = ranges_of(*self._hear_each(RANGE))
        if all(reading.state == "fault" for reading in readings.values()):
            silence = self._silence("no range was ever heard; check that giraff_ranger runs and sees its board")
            if not readings or isinstance(silence, NoRobotError):
                raise silence
        return readings

    def sensed(self, sample: type[SampleT]) -> dict[str, SampleT]:
        """Return the newest sample of each sensor of one type, by name: `sensed(Bump)` is of all bumpers.

        It leaves out none that the guard names, and raises SilentError where one, or the guard, was silent for a
        second. It waits for the first samples as `ranges` does. Empty: the robot has no such sensor. Raises
        LostRobotError, and ValueError for a type of sample that no sensor gives.
        """
        if sample not in SENSE_OF:
            known = ", ".join(each.__name__ for each in SENSE_OF)
            raise ValueError(f"sensed({sample.__name__}): no sensor gives such samples; take one of {known}")
        topic = SENSED[SENSE_OF[sample]]
        named = _named(topic, self.guard())
        heard, now = self._hear_each(topic)
        found = {name: _newest(topic, name, heard, now) for name in named}
        if silent := [str(silence) for _, silence in found.values() if silence]:
            raise self._silence("; ".join(silent))
        return {name: newest for name, (newest, _) in found.items() if isinstance(newest, sample)}

    @abstractmethod
    def _hear_each(self, topic: Topic[Any]) -> tuple[Heard, float]:
        """Return all that was heard, and the time, once each sensor of a topic was heard or is not waited for."""

    @abstractmethod
    def _silence(self, text: str) -> RobotError:
        """Return SilentError with this text, or LostRobotError."""

    @abstractmethod
    def _fresh(self, topic: Topic[SampleT], remedy: str) -> SampleT:
        """The newest, unless it says nothing of now. Raises SilentError with the way out, LostRobotError."""


def has_heard_each_sensor(topic: Topic[Any], heard: Heard) -> bool:
    """Whether each sensor of a topic was heard. The guard tells which there are: those of the robot file."""
    return GUARD.key in heard and all(topic.key.replace("*", name) in heard for name in _sensors(topic, heard))


def ranges_of(heard: Heard, now: float) -> dict[str, Range]:
    """By sensor, of all that the guard names and all that were heard: its newest reading, or why there is none."""
    return {sensor: _range_of(sensor, heard, now) for sensor in _sensors(RANGE, heard)}


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


def _sensors(topic: Topic[Any], heard: Heard) -> list[str]:
    state, _ = heard.get(GUARD.key, (None, 0.0))
    told = _named(topic, state) if isinstance(state, GuardState) else []
    return sorted({*told, *(topic.name_in(key) for key in heard if covers(topic, key))})


def _named(topic: Topic[Any], state: GuardState) -> list[str]:
    return [name for name, kind in state.sensor_types.items() if kind == SENSE_OF[topic.schema].type_name()]


def _newest(topic: Topic[Any], name: str, heard: Heard, now: float) -> tuple[Sample | None, Trouble]:
    """Return the newest sample of a sensor, and why it says nothing of now."""
    key, service = topic.key.replace("*", name), PUBLISHERS[SENSE_OF[topic.schema].type_name()]
    newest, at = heard.get(key, (None, 0.0))
    if newest is None:
        return None, Trouble(f"{key} was never heard", f"check that giraff_{service} runs, and this sensor's wires")
    if is_fresh(topic, now - at):
        return newest, NO_TROUBLE
    return newest, Trouble(f"{key} is silent for {now - at:.1f} s", f"check giraff_{service} and its board")


def _range_of(sensor: str, heard: Heard, now: float) -> Range:
    reading, silence = _newest(RANGE, sensor, heard, now)
    if not isinstance(reading, Range):
        return Range(sensor=sensor, state="fault", range=None, echo_us=0, reason=silence, tick=None)
    if not silence:
        return reading
    return msgspec.structs.replace(reading, state="fault", range=None, echo_us=0, reason=silence)
