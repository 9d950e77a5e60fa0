"""Samples as the services would make them, and a telemetry that has heard ten seconds of a drive."""

import math
from typing import Any

import msgspec

from giraff_cli.run.telemetry import RunTelemetry, Truth
from giraff_core.estop.latch import SEE_THAT_IT_MAY
from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Bumper, Ultrasonic
from giraff_schemas import topics
from giraff_schemas.bumper import Bump
from giraff_schemas.camera import Asker, CameraState, VisualOdometry
from giraff_schemas.codec import stamped
from giraff_schemas.messages import (
    Attitude,
    BaseState,
    Battery,
    BoardState,
    Clearance,
    DirectionLimit,
    DriveCommand,
    EStop,
    GuardedCommand,
    GuardState,
    Lease,
    Odometry,
    Range,
    RangeState,
    RobotTime,
    SensorState,
    Tick,
    Tilt,
    Wheels,
)
from giraff_schemas.motion import IDLE
from giraff_schemas.topics import Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_telemetry.collector import Telemetry

SENSORS = ("front_left", "front_right", "rear")
TYPES = dict.fromkeys(SENSORS, Ultrasonic.type_name())
BUMPERS = ("front", "back")
EPOCH = 7
START = Pose(1.5, 2.2, 0.0)
MS = 1_000_000


def at(robot_ns: int) -> RobotTime:
    return RobotTime(epoch=EPOCH, robot_ns=robot_ns)


def truth(robot_ns: int, *, x: float = 0.0, simulated_us: int | None = None, speed: float = 0.0) -> Truth:
    """A robot that went `x` m straight on from the start."""
    return Truth(
        robot_ns=robot_ns,
        simulated_us=robot_ns // 1000 if simulated_us is None else simulated_us,
        pose=Pose(START.x + x, START.y, START.yaw),
        speed=speed,
        turn=0.0,
        path=abs(x),
        closest=0.42,
        contacts=0,
    )


def odometry(robot_ns: int, x: float, y: float = 0.0, yaw: float = 0.0) -> Odometry:
    return Odometry(
        x=x,
        y=y,
        yaw=yaw,
        linear_x=0.4,
        angular_z=0.0,
        covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        path=abs(x),
        board_us=robot_ns // 1000,
        boot_id=1,
        tick=at(robot_ns),
    )


def command(operator_ns: int | None, *, reason: str = "", epoch: int = EPOCH) -> GuardedCommand:
    tick = None if operator_ns is None else RobotTime(epoch=epoch, robot_ns=operator_ns)
    return GuardedCommand(
        linear_x=0.4,
        angular_z=-0.2,
        guard_tick=tick,
        operator="hand",
        lease_counter=1,
        operator_tick=tick,
        range_tick=None,
        source="hand",
        faults=0,
        hand_neutral=False,
        reason=Trouble(reason),
    )


def wish(linear: float, angular: float, robot_ns: int) -> DriveCommand:
    """A joystick's."""
    return DriveCommand(
        operator="joystick", lease_counter=1, linear_x=linear, angular_z=angular, source="hand", tick=at(robot_ns)
    )


def wheels(robot_ns: int) -> Wheels:
    return Wheels(
        left_ticks=0,
        right_ticks=0,
        left_velocity=0.0,
        right_velocity=0.0,
        left_pwm_counts=0,
        right_pwm_counts=0,
        board_us=robot_ns // 1000,
        boot_id=1,
        tick=at(robot_ns),
    )


def attitude(robot_ns: int, posture: str = "stands", cause: str = "") -> Attitude:
    """A robot that leans forward by 1.5 degrees."""
    lean = math.radians(1.5)
    return Attitude(
        lean=lean,
        rate=-0.1,
        accelerometer_lean=2.0 * lean,
        trim=0.0,
        torque=-12.5,
        posture=posture,
        cause=cause,
        tick=at(robot_ns),
    )


def verdict(
    allowed: float = 1.0, clearance: Clearance = "free", sensor: str = "", reason: str = "", remedy: str = ""
) -> DirectionLimit:
    return DirectionLimit(allowed=allowed, clearance=clearance, sensor=sensor, reason=Trouble(reason, remedy))


def guard(forward: DirectionLimit) -> GuardState:
    return GuardState(
        forward=forward,
        backward=verdict(),
        turn_left=verdict(),
        turn_right=verdict(),
        operator="hand",
        reason=forward.reason,
        sensors={name: SensorState(type=kind) for name, kind in TYPES.items()},
    )


def with_bumpers(forward: DirectionLimit) -> GuardState:
    """Of a robot that has bumpers, too."""
    state = guard(forward)
    bumpers = dict.fromkeys(BUMPERS, SensorState(type=Bumper.type_name()))
    return msgspec.structs.replace(state, sensors=state.sensors | bumpers)


def base(
    *,
    armed: bool = True,
    reason: str | Trouble = "",
    line_errors: int = 0,
    latch: str = "none",
    drive_state: str = "active",
) -> BaseState:
    board = BoardState(
        connected=True,
        boot_id=1,
        drive_state=drive_state,
        latch=latch,
        last_refusal="none",
        accepted=1,
        refused=0,
        line_errors=line_errors,
    )
    why = Trouble(reason) if isinstance(reason, str) else reason
    return BaseState(
        armed=armed, driving=armed, reason=why, guard="guard", round_trip=0.02, budget_left=0.1, board=board
    )


def estop(*, engaged: bool = False) -> EStop:
    smoke = Trouble("smoke", SEE_THAT_IT_MAY, "release")
    return EStop(engaged=engaged, id=3, by="ann@desk" if engaged else "", reason=smoke if engaged else NO_TROUBLE)


def lease(holder: str = "hand", operator: str = "joystick") -> Lease:
    return Lease(holder=holder, operator=operator, counter=1 if holder else 0)


def reading(sensor: str, distance: float | None, state: RangeState = "echo", reason: str = "") -> Range:
    return Range(sensor=sensor, state=state, range=distance, echo_us=0, reason=Trouble(reason), tick=None)


def bump(sensor: str, *, pressed: bool = False) -> Bump:
    return Bump(sensor=sensor, pressed=pressed, tick=None)


def camera(*askers: str, reason: str = "") -> CameraState:
    """A camera that is called head, and who looks."""
    return CameraState(
        camera="head",
        askers=tuple(Asker(instance=by, by=by, size="full") for by in askers),
        width=320,
        height=240,
        rate=14.9 if askers else 0.0,
        reason=Trouble(reason),
    )


def seen(robot_ns: int, x: float, reason: str = "", blind_m: float = 0.0, remedy: str = "") -> VisualOdometry:
    """A picture that was taken then, by which the robot went `x` m since the first."""
    return VisualOdometry(
        camera="head",
        picture=robot_ns // MS,
        tick=at(robot_ns - 10 * MS),
        since_tick=0.01,
        key=0,
        reason=Trouble(reason, remedy),
        motion=None,
        path=(x, 0.0, math.radians(0.5) if x else 0.0),
        seen_m=x - blind_m,
        blind_m=blind_m,
    )


class Network:
    """Numbers samples as publishers do, and lets a telemetry hear them."""

    def __init__(self, telemetry: Telemetry) -> None:
        self.telemetry = telemetry
        self._seq: dict[tuple[str, str], int] = {}

    def send(
        self, topic: Topic[Any], sample: Any, at_ns: int, *, name: str = "", maker: str = "m", lose: bool = False
    ) -> None:
        key = topic.at(name).key if name else topic.key
        seq = self._seq.get((key, maker), 0)
        self._seq[key, maker] = seq + 1
        if not lose:
            self.telemetry.on_sample(topic, key, stamped(sample, seq, 0, maker), at_ns)


def ten_seconds() -> RunTelemetry:
    """A run that has heard ten seconds of it."""
    telemetry = RunTelemetry(TYPES, truth(0))
    drive_ten_seconds(telemetry)
    return telemetry


def drive_ten_seconds(telemetry: Telemetry) -> None:
    """Straight on with 0.4 m/s, everything in order."""
    network = Network(telemetry)
    for service in ("joystick", "guard", "base", "ranger", "odometry", "motion"):
        telemetry.on_liveliness(service, "m", present=True)
    for ms in range(0, 10_001, 10):
        now, x = ms * MS, 0.4e-3 * ms
        network.send(topics.WHEELS, wheels(now), now)
        network.send(topics.ODOM, odometry(now, x), now)
        if ms % 20 == 0:
            network.send(topics.TICK, Tick(epoch=EPOCH, robot_ns=now), now)
            network.send(topics.TILT, Tilt(x=2.5, y=-0.4, z=9.4, status="running", tick=at(now)), now)
            network.send(topics.CMD_VEL, command(max(0, now - 31 * MS)), now)
        if ms % 30 == 0:
            network.send(topics.OPERATOR_CMD_VEL, wish(0.4, -0.2, now), now, name="joystick")
        if ms % 180 == 0:
            network.send(topics.RANGE, reading("front_left", 1.23), now, name="front_left")
            network.send(topics.RANGE, reading("front_right", None, "clear"), now, name="front_right")
            network.send(topics.RANGE, reading("rear", None, "fault", "stuck"), now, name="rear")
        if ms % 100 == 0:
            slow = verdict(0.3, "slow", sensor="front_left", reason="1.23 m ahead", remedy="turn away")
            network.send(topics.GUARD, guard(slow), now)
            network.send(topics.BASE, base(), now)
            network.send(topics.LEASE, lease(), now)
            network.send(topics.MOTION, IDLE, now)
        if ms % 500 == 0:
            network.send(topics.BATTERY, Battery(voltage=24.3), now)
            network.send(topics.ESTOP, estop(), now)
        if isinstance(telemetry, RunTelemetry) and ms % 200 == 0 and ms:
            telemetry.see(truth(now, x=x, speed=0.4))
