"""The samples that services exchange: frozen Structs, SI units, REP-103 axes (x forward, y left, yaw to the left).

A sample is a MessagePack map. A reader ignores fields that it does not know, and refuses missing ones, wrong types and
numbers that are not finite. `__post_init__` checks this at both ends; `codec.stamped` makes its copy without that.
"""

from typing import Literal

import msgspec

from giraff_schemas.checks import require_finite, require_moment
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class RobotTime(msgspec.Struct, frozen=True):
    """A moment on the robot's own clock, as base published it in a `Tick`.

    At base, no measurement or wish that carries one is older than `now - robot_ns`, whatever other clocks say.
    """

    epoch: int
    """Random, one per start of base; 0 is nobody's. Moments of different epochs cannot be compared."""
    robot_ns: int
    """CLOCK_BOOTTIME of base's host, ns: it goes on while the machine is suspended."""

    def __post_init__(self) -> None:
        require_moment(self.epoch, self.robot_ns)


class Sample(msgspec.Struct, frozen=True, kw_only=True):
    """What every sample starts with. A policy leaves it out; the publisher fills it in (`codec.stamped`)."""

    seq: int = 0
    """Counts the samples of this maker on this key, from 0, without gaps."""
    stamp_ns: int = 0
    """Wall clock of the maker's host, ns since 1970: for people and recordings, never for a decision."""
    instance: str = ""
    """Random id of the process that made the sample; an empty one is refused on decoding."""


class Tick(Sample, frozen=True, kw_only=True):
    """The robot's clock, from base. See `RobotTime`."""

    epoch: int
    robot_ns: int

    def __post_init__(self) -> None:
        require_moment(self.epoch, self.robot_ns)
        if self.epoch == 0:
            raise ValueError("epoch is 0, which is nobody's")

    @property
    def time(self) -> RobotTime:
        return RobotTime(epoch=self.epoch, robot_ns=self.robot_ns)


TiltStatus = Literal["running", "starting", "bus_fault", "wrong_chip", "self_test_failed", "system_error", "no_board"]


class Tilt(Sample, frozen=True, kw_only=True):
    """Acceleration in the operator's hand, m/s²: at rest it is gravity, seen from the tilted sensor."""

    x: float
    y: float
    z: float
    status: TiltStatus
    tick: RobotTime | None
    """Newest moment the board held when it began the reading."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.z)


Source = Literal["hand", "fault"]
Side = Literal["forward", "backward", "none"]
RangeState = Literal["echo", "clear", "fault"]


class DriveCommand(Sample, frozen=True, kw_only=True):
    """What an operator asks of the robot."""

    operator: str
    """Name of the operator, as in the key."""
    lease_counter: int
    """Of the lease that the command is given under (`Lease.counter`); 0 asks for the lease."""
    linear_x: float
    """m/s, forward positive."""
    angular_z: float
    """rad/s, counter-clockwise positive."""
    source: Source
    """`hand`: a human's wish. `fault`: the operator's side lost the hand; always neutral, and arms nothing."""
    reason: Trouble = NO_TROUBLE
    """The fault."""
    tick: RobotTime | None
    """Of the measurement or human event, never renewed. None: the operator has not heard the robot yet."""

    def __post_init__(self) -> None:
        require_finite(self, self.linear_x, self.angular_z)

    @property
    def neutral(self) -> bool:
        return self.linear_x == 0.0 and self.angular_z == 0.0


class GuardedCommand(Sample, frozen=True, kw_only=True):
    """What the guard lets through to base: the only samples that move motors."""

    linear_x: float
    angular_z: float
    guard_tick: RobotTime | None
    """Newest moment the guard held when it decided."""
    operator: str
    """Instance whose command this is, the holder of the lease; empty: nobody's."""
    lease_counter: int
    """Of the lease in force; another one than before disarms. 0: nobody holds it."""
    operator_tick: RobotTime | None
    range_tick: RobotTime | None
    """Oldest moment of the ranges that the wish relies on; robot_ns 0 if one never came. None: it relies on none."""
    source: Source
    faults: int
    """Faults of `source` since the guard began. Another number disarms: each word has it, should a fault's be lost."""
    hand_neutral: bool
    """The operator's own command is a hand's and neutral: what arms the robot when held."""
    reason: Trouble = NO_TROUBLE
    """Cause, where this is less than the operator asked for."""
    free_side: Side = "none"
    """Where a robot that sits down has room, by the ranges of now."""
    heard: tuple[int, ...] = ()
    """Numbers of the newest samples that the guard had heard, as its `HEARD` orders them, for a replay. -1: none."""
    decided_us: int = -1
    """µs from `guard_tick` to the guard's decision, for a replay. -1: it has no tick."""

    def __post_init__(self) -> None:
        require_finite(self, self.linear_x, self.angular_z)

    @property
    def neutral(self) -> bool:
        return self.linear_x == 0.0 and self.angular_z == 0.0


class Lease(Sample, frozen=True, kw_only=True):
    """Whom the guard obeys: (operator instance, guard instance, counter). The guard's is the sample's `instance`."""

    holder: str
    """Instance of the operator; empty: it is free to the first who asks."""
    operator: str
    """Name of the holder; empty: none."""
    counter: int
    """Another one for each grant, never 0; what the holder's commands must carry. 0: free."""
    reason: Trouble = NO_TROUBLE
    """Cause of the newest grant, refusal or end. The remedy is for an operator who wants to drive."""
    unranked: tuple[str, ...] = ()
    """Operators that have asked to drive, and whose names no table ranks: persons take the robot from them."""


class EStop(Sample, frozen=True, kw_only=True):
    """The emergency stop: base's state, and only base's."""

    engaged: bool
    id: int
    """Names this latch: a reset that names another clears nothing."""
    by: str
    """Who engaged it, or reset it."""
    reason: Trouble = NO_TROUBLE
    engaged_ns: int = 0
    """Robot time of the newest request to stop, also of one that finds it engaged; 0: none since base began."""
    off: bool = False
    """The stop has switched off a drive that else holds the robot up. Always false where the drive has no such off."""


class SerialLine(Sample, frozen=True, kw_only=True):
    """A line of text that a board has printed, without its end."""

    name: str
    """Of the port, as in the key."""
    text: str
    goes_on: bool = False
    """It was too long: the next sample has the rest of it."""
    replaced: int = 0
    """Places in it that were no UTF-8, and are U+FFFD now."""


class SerialWrite(Sample, frozen=True, kw_only=True):
    """A text for a board, without the end that the gateway puts after it."""

    name: str
    text: str


class Range(Sample, frozen=True, kw_only=True):
    """One reading of one ultrasonic sensor."""

    sensor: str
    state: RangeState
    """`clear`: nothing answered within the sensor's reach, which is not proof that nothing is there."""
    range: float | None
    """m from the sensor; only of an echo."""
    echo_us: int
    """Length of the echo pulse as the board measured it; 0 = none."""
    reason: Trouble = NO_TROUBLE
    """The fault."""
    tick: RobotTime | None
    """Newest moment the board held when it triggered the ping."""

    def __post_init__(self) -> None:
        if (self.range is not None) != (self.state == "echo"):
            raise ValueError(f"range {self.range!r} does not go with state {self.state!r}")
        if self.range is not None:
            require_finite(self, self.range)


class Wheels(Sample, frozen=True, kw_only=True):
    """Encoders and motors as the base board reports them."""

    left_ticks: int
    """Signed 32-bit counter, wraps; forward positive. Comparable only within one `boot_id`."""
    right_ticks: int
    left_velocity: float
    """m/s, as the board measures it: from the encoder's edges and the time between them."""
    right_velocity: float
    left_pwm_counts: int
    """What the motor gets, of 255; forward positive."""
    right_pwm_counts: int
    board_us: int
    """Board's clock when the ticks were read; unsigned 32 bit, wraps after 71 minutes."""
    boot_id: int
    tick: RobotTime
    """When base read the report."""

    def __post_init__(self) -> None:
        require_finite(self, self.left_velocity, self.right_velocity)


class Attitude(Sample, frozen=True, kw_only=True):
    """How a robot that balances holds itself, as its board measures it. Leaning forward is positive."""

    lean: float
    """rad from upright: gyroscope and accelerometer together."""
    rate: float
    """rad/s."""
    accelerometer_lean: float
    """rad, by the accelerometer alone."""
    trim: float
    """rad. The lean at which it stands."""
    torque: float
    """N m of both motors, at the wheels."""
    posture: str
    """`off`, `stands` or `sits down`."""
    cause: str
    """Why it is off or sits down; empty: it has not stood since its board began."""
    tick: RobotTime
    """When base read the report."""
    pivot: float = 0.0
    """m. Height above the floor of the axle, about which it leans."""

    def __post_init__(self) -> None:
        require_finite(self, self.lean, self.rate, self.accelerometer_lean, self.trim, self.torque, self.pivot)


class Odometry(Sample, frozen=True, kw_only=True):
    """Pose of `base_link` in `odom`, and twist in `base_link`, from the wheels alone."""

    x: float
    y: float
    yaw: float
    """rad, in (-pi, pi]."""
    linear_x: float
    angular_z: float
    covariance: tuple[float, float, float, float, float, float]
    """Of (x, y, yaw): xx, xy, xyaw, yy, yyaw, yawyaw; m², m·rad, rad². Grows with way and turn."""
    path: float
    """m travelled by the robot's centre, backwards counted too; a way back of less than 1 cm is not counted."""
    board_us: int
    boot_id: int
    tick: RobotTime
    jumps: int = 0
    """Number of times that its pose was set from outside since odometry began. Each one begins another `segment`."""
    breaks: int = 0
    """How often the wheels could not be followed, or only over a gap: what that may have missed is in `covariance`."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw, self.linear_x, self.angular_z, self.path, *self.covariance)

    @property
    def segment(self) -> tuple[str, int]:
        """Between two samples of which this differs lies no motion: the pose was set, or odometry began anew."""
        return self.instance, self.jumps


class TruePose(Sample, frozen=True, kw_only=True):
    """True `base_link` in `odom` of a simulated robot, for people who look at it. Nothing on a robot may hear it."""

    x: float
    y: float
    yaw: float
    """rad, in (-pi, pi]."""
    tick: RobotTime
    walls: tuple[tuple[tuple[float, float], ...], ...] = ()
    """m. Lines of the simulated room, in `odom`. Said every 2 s and empty in between."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw, *(each for line in self.walls for at in line for each in at))


class BoardState(msgspec.Struct, frozen=True, kw_only=True):
    """The base board, as its newest report shows it. It reports each `report_ms`."""

    connected: bool
    boot_id: int
    drive_state: str
    latch: str
    last_refusal: str
    accepted: int
    refused: int
    line_errors: int
    report_ms: int = 10


class BaseState(Sample, frozen=True, kw_only=True):
    """Whether base drives, and if not, why."""

    armed: bool
    driving: bool
    """The newest frame to the board asked for motion."""
    reason: Trouble = NO_TROUBLE
    """Cause, where the robot does not do what the guard let through."""
    guard: str
    """Instance of the guard that base is bound to; empty: none yet."""
    round_trip: float | None
    """s from the operator's measurement to base's newest frame to the board (age of its tick)."""
    budget_left: float | None
    """s until the first of the ticks in use is too old; negative: it is."""
    board: BoardState

    def __post_init__(self) -> None:
        require_finite(self, self.round_trip or 0.0, self.budget_left or 0.0)


class Battery(Sample, frozen=True, kw_only=True):
    voltage: float
    """V."""
    since_charge: float | None = None
    """s since base last saw a charge; None: it has seen none since it began."""

    def __post_init__(self) -> None:
        require_finite(self, self.voltage, self.since_charge or 0.0)


Direction = Literal["forward", "backward", "turn_left", "turn_right"]
Clearance = Literal["free", "slow", "creep", "blocked"]


class DirectionLimit(msgspec.Struct, frozen=True, kw_only=True):
    """What the guard allows in one direction now."""

    allowed: float
    """m/s (forward, backward) or rad/s (turns), never negative."""
    clearance: Clearance
    sensor: str
    """The sensor that limits; empty: none does."""
    reason: Trouble = NO_TROUBLE

    def __post_init__(self) -> None:
        require_finite(self, self.allowed)


class SensorState(msgspec.Struct, frozen=True, kw_only=True):
    """A sensor as the guard judges it."""

    type: str
    """Type of the sensor in the robot file."""
    trouble: Trouble = NO_TROUBLE
    """Cause of the guard's distrust; false where the guard trusts it."""


class GuardState(Sample, frozen=True, kw_only=True):
    """The guard's verdict for each direction, and what it does with the operator's command."""

    forward: DirectionLimit
    backward: DirectionLimit
    turn_left: DirectionLimit
    turn_right: DirectionLimit
    operator: str
    """Instance the guard listens to, the holder of the lease; empty: none."""
    reason: Trouble = NO_TROUBLE
    """Cause, where the guard cut the newest command."""
    sensors: dict[str, SensorState]
    """By name, in the order of the robot file."""

    @property
    def sensor_types(self) -> dict[str, str]:
        """Return the type of each sensor by name."""
        return {name: sensor.type for name, sensor in self.sensors.items()}
