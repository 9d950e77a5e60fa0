"""Table `[guard]` of the robot file."""

import math
from typing import Annotated, Final

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.differential_drive import CREEP
from giraff_core.tuning import Tuning
from giraff_schemas.services import DEMONSTRATION, HANDS, MOTION, ROS2, SCRIPT

PRIORITIES: Final = {MOTION.name: -1, DEMONSTRATION: -2}
"""Of who is not named: any person comes before a motion, and before the demonstration of `giraff run`."""
_KNOWN: Final = dict.fromkeys(HANDS, 0) | {SCRIPT: -1, ROS2.name: -1} | PRIORITIES
_UNKNOWN: Final = -1
"""Priority of a name that stands in no table: below persons' hands, because it may be a program's."""


class GuardConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    margin: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 2.0, "m")] = 0.25
    """m kept between the robot's footprint and an obstacle."""
    release: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.001, 1.0, "m")] = 0.05
    """m beyond `margin` before a blocked direction is opened again."""
    reaction_time: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 2.0, "s")] = 0.10
    """s from an echo at the sensor to the wheels slowing down, without the reading's age."""
    deceleration: Annotated[float | None, Tuning.LOWER_ONLY, Bounds(0.05, 10.0, "m/s²")] = None
    """m/s² that the stopping distance counts on; the robot's real one must be larger. None: it has not been measured,
    and the robot creeps."""
    run_on: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.0, 1.0, "m")] = 0.0
    """m that every stop takes besides: to brake, a robot that balances first runs on, so that it leans back."""
    room_behind: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.0, 1.0, "m")] = 0.0
    """m beyond the footprint that must be free the other way before the robot drives. A robot that balances rolls back
    as it drives off, and after a stop. 0: the robot does not roll back."""
    range_budget: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.05, 2.0, "s")] = 0.40
    """s; an older reading does not count: its directions are blind."""
    operator_budget: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.05, 2.0, "s")] = 0.4
    """s; an older command does not count."""
    operator_release: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.1, 60.0, "s")] = 1.0
    """s without a fresh command of its holder after which the lease ends."""
    fault_release: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.1, 600.0, "s")] = 2.0
    """s of its holder's fault after which the lease ends."""
    idle_release: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.1, 86_400.0, "s")] = 30.0
    """s of its holder's neutral hand after which the lease ends."""
    publisher_timeout: Annotated[float, Tuning.READ_ONLY, Bounds(0.1, 10.0, "s")] = 0.5
    """s of silence after which another base or ranger may take the place of the one that is listened to."""
    priorities: Annotated[dict[str, int], Tuning.READ_ONLY] = msgspec.field(default_factory=PRIORITIES.copy)
    """By operator name: who may take the lease from whom. A larger one may. Where this table does not name them,
    `joystick`, `keyboard` and `web` have 0, `motion`, `script`, `ros2` and any other name -1, and `demo` -2."""
    creep_linear: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.005, 0.5, "m/s")] = CREEP
    """m/s where no sensor looks."""
    creep_angular: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.01, 5.0, "rad/s")] = 0.35
    """rad/s while the way ahead is blocked."""
    min_speed: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.001, 0.5, "m/s")] = 0.03
    """m/s; less is a stop."""
    reach: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.1, 20.0, "m")] = 10.0
    """m that `clear` counts for at most, whatever reach the sensor has in the robot file."""
    half_cone: Annotated[float | None, Tuning.READ_ONLY, Bounds(0.001, math.pi / 4, "rad")] = None
    """rad; of all ultrasonic sensors, in place of what each has. None: as `[robot.sensors.<name>]` has it."""
    incidence: Annotated[float | None, Tuning.READ_ONLY, Bounds(0.001, math.pi / 2, "rad")] = None
    """rad; as of `half_cone`."""
    trust_full_time: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.5, 60.0, "s")] = 10.0
    """s after a sensor's last plausible echo, up to which its `clear` counts in full."""
    trust_full_travel: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.1, 5.0, "m")] = 1.2
    """m of way after it, up to which its `clear` counts in full."""
    trust_full_turn: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.05, 10.0, "m/rad")] = 0.5
    """m of way that a turn counts as, by rad."""
    trust_end_time: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.5, 120.0, "s")] = 20.0
    """s after it, from which on its `clear` is worth `untrusted_speed`."""
    trust_end_travel: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.1, 10.0, "m")] = 2.0
    """m of way after it, from which on its `clear` is worth that."""
    untrusted_speed: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.005, 0.5, "m/s")] = 0.145
    """m/s towards what only a silent sensor looks at, and to where something was heard until lately."""
    silent_range: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.1, 10.0, "m")] = 2.2
    """m from the sensor; a plausible echo within it counts on when its way's sensors fall silent."""
    silent_time: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.5, 120.0, "s")] = 20.0
    """s for which it does."""
    silent_radius: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 1.0, "m")] = 0.10
    """m around the spot in which what gave it may stand."""
    silent_beside: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 2.0, "m")] = 0.45
    """m between the footprint and such a spot beside it, within which the robot is slowed too."""
    silent_block: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 60.0, "s")] = 1.0
    """s of silence for which it may block a way; then it slows it to `untrusted_speed`."""
    touch_distance: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 1.0, "m")] = 0.10
    """m; an echo lost below it blocks its direction until the robot has moved or turned away."""
    recovery_step: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.001, 5.0, "m/s")] = 0.12
    """m/s that each further reading of the sensor that blocked a way adds to creeping."""
    range_tolerance: Annotated[float, Tuning.READ_ONLY, Bounds(0.001, 1.0, "m")] = 0.10
    """m by which two readings of one surface may differ, besides motion."""
    person_speed: Annotated[float, Tuning.READ_ONLY, Bounds(0.01, 10.0, "m/s")] = 1.0
    """m/s at which what a sensor sees may move."""
    frozen_travel: Annotated[float, Tuning.LOWER_ONLY, Bounds(0.01, 10.0, "m")] = 0.20
    """m along a sensor's axis after which a reading that has not changed at all is frozen."""
    memory_range: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 10.0, "m")] = 1.6
    """m from the sensor; echoes farther away are not remembered."""
    memory_time: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.1, 600.0, "s")] = 20.0
    """s after which a remembered echo is forgotten."""
    memory_travel: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.01, 100.0, "m")] = 2.0
    """m of travel after which it is forgotten."""
    memory_block: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.1, 600.0, "s")] = 8.0
    """s for which a remembered echo may block a way; then it slows it to `untrusted_speed`."""
    memory_margin: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.001, 1.0, "m")] = 0.05
    """m kept between the footprint and remembered echoes."""
    sit_room: Annotated[float, Tuning.RAISE_ONLY, Bounds(0.05, 3.0, "m")] = 0.35
    """m beyond the footprint that a balancing robot needs free on the side to which it sits down."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.trust_full_time >= self.trust_end_time or self.trust_full_travel >= self.trust_end_travel:
            raise ValueError(
                "a sensor's full trust must end before its trust does: trust_full_time < trust_end_time, "
                "trust_full_travel < trust_end_travel; to lower both, begin with trust_full_time and trust_full_travel"
            )
        if self.untrusted_speed < self.min_speed:
            raise ValueError(
                f"untrusted_speed is {self.untrusted_speed:g} m/s and min_speed {self.min_speed:g} m/s: less than "
                "min_speed is a stop, and nothing would ever be proved: untrusted_speed >= min_speed"
            )

    def rank(self, operator: str) -> int:
        """Return the priority of an operator. Only a larger one takes the lease from another."""
        return self.priorities.get(operator, _KNOWN.get(operator, _UNKNOWN))

    def ranks(self, operator: str) -> bool:
        """Return whether a table names the operator. Another name may be a hand's that was set without a priority."""
        return operator in self.priorities or operator in _KNOWN
