"""Obstacles with sensors and wheels in simulated robot time: the rig of these tests."""

import math
import pickle
from collections.abc import Mapping
from typing import Final

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import HC_SR04
from giraff_guard.config import GuardConfig
from giraff_guard.judge.memory import Echoes
from giraff_guard.limits import Limits
from giraff_guard.obstacles import Limited, Obstacles, Verdicts
from giraff_guard.source import Beam
from giraff_schemas.messages import Attitude, DirectionLimit, Range, RobotTime, Wheels
from giraff_schemas.trouble import Trouble
from tests.unit.guard.rig import CONFIG, EPOCH, FAR, FRONT, NEAR, ROBOT, robot_with

__all__ = [
    "CONFIG",
    "CYCLE",
    "EPOCH",
    "FAR",
    "FRONT",
    "NEAR",
    "ROBOT",
    "SIDES",
    "Senses",
    "attitude",
    "beam",
    "opened",
    "raised",
    "robot_with",
]

CYCLE: Final = 0.18  # s: each sensor once
PIVOT: Final = 0.175  # m
HEIGHT: Final = 0.30  # m of each sensor above the floor
_TURN: Final = 0.06  # s
_OPENED: Final[dict[bytes, bytes]] = {}
"""The senses that `opened` has made, by what it was given: many tests begin with the same."""
ORIGIN: Final = Pose(0.0, 0.0, 0.0)
SIDES: Final = {"forward": FRONT, "backward": ("rear",)}


def raised(robot: RobotConfig) -> RobotConfig:
    """Return a robot whose file says how high its sensors are."""
    sensors = {name: msgspec.structs.replace(pose, z=HEIGHT) for name, pose in robot.sensors.items()}
    return msgspec.structs.replace(robot, sensors=sensors)


def attitude(angle: float, tick: RobotTime, *, seq: int = 0, instance: str = "") -> Attitude:
    """Return what base tells of a body that leans by this angle about an axle 0.175 m up."""
    return Attitude(
        seq=seq,
        instance=instance,
        lean=angle,
        rate=0.0,
        accelerometer_lean=angle,
        trim=0.0,
        torque=0.0,
        posture="stands",
        cause="",
        pivot=PIVOT,
        tick=tick,
    )


class Senses:
    """Feed it, let it drive, and ask what it thinks."""

    def __init__(self, robot: RobotConfig = ROBOT, config: GuardConfig = CONFIG) -> None:
        self.robot = robot
        self.config = config
        self.live = Live(config)
        self.obstacles = Obstacles(self.live, robot)
        self.robot_ns = 1_000_000_000_000
        self.linear = self.angular = 0.0
        """What the robot does: m/s, rad/s."""
        self.asked = (0.0, 0.0)
        self._left = self._right = 0.0  # m of wheel travel
        self._seq = 0

    @property
    def now(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=self.robot_ns)

    def ago(self, seconds: float, epoch: int = EPOCH) -> RobotTime:
        return RobotTime(epoch=epoch, robot_ns=self.robot_ns - round(seconds * 1e9))

    def wait(self, seconds: float, *, wheels: bool = True) -> None:
        """Let time pass in the guard's turns, the robot moving as it does."""
        turns = math.ceil(round(seconds / _TURN, 6))
        for _ in range(turns):
            turn = seconds / turns
            self.robot_ns += round(turn * 1e9)
            half = self.angular * self.robot.track_width / 2.0
            self._left += (self.linear - half) * turn
            self._right += (self.linear + half) * turn
            if wheels:
                self.report()
            if self.config.run_on:
                self.lean(0.0)
            self.judge()
            self.limit(*self.asked)

    def report(self, age: float = 0.0, boot_id: int = 1) -> None:
        """What the wheels say now."""
        half = self.angular * self.robot.track_width / 2.0
        report = Wheels(
            instance="base",
            left_ticks=math.floor(self._left * self.robot.ticks_per_metre),
            right_ticks=math.floor(self._right * self.robot.ticks_per_metre),
            left_velocity=self.linear - half,
            right_velocity=self.linear + half,
            left_pwm_counts=0,
            right_pwm_counts=0,
            board_us=self.robot_ns // 1000 & 0xFFFFFFFF,
            boot_id=boot_id,
            tick=self.ago(age),
        )
        self.obstacles.on_wheels(report, self.now)

    def lean(self, angle: float, age: float = 0.0) -> None:
        """Hear from base that the body leans so."""
        self.obstacles.on_attitude(attitude(angle, self.ago(age)))

    def hear(
        self,
        distance: float | None,
        *sensors: str,
        age: float = 0.0,
        fault: str = "",
        tick: RobotTime | None = None,
        echo_us: int | None = None,
    ) -> None:
        """A reading of these sensors, or of all; None: nothing within reach."""
        for name in sensors or self.robot.sensors:
            self._seq += 1
            measured = None if fault else distance
            pulse = round(measured * 5800) if measured is not None else 38_000
            reading = Range(
                seq=self._seq,
                instance="ranger",
                sensor=name,
                state="fault" if fault else "clear" if measured is None else "echo",
                range=measured,
                echo_us=pulse if echo_us is None else echo_us,
                reason=Trouble(fault),
                tick=self.ago(age) if tick is None else tick,
            )
            self.obstacles.on_sensed(reading, self.now)

    def cycle(self, distances: Mapping[str, float | None] | float | None = FAR, cycles: int = 1) -> None:
        """As the ranger board has it: a sensor each 60 ms, in turn."""
        for _ in range(cycles):
            for name in self.robot.sensors:
                self.wait(CYCLE / len(self.robot.sensors))
                seen = distances.get(name, FAR) if isinstance(distances, Mapping) else distances
                self.hear(seen, name)
                self.judge()

    def judge(self) -> Verdicts:
        return self.obstacles.judge(self.now)

    def troubles(self) -> dict[str, Trouble]:
        self.judge()
        return self.obstacles.troubles(self.now)

    def limit(self, linear: float, angular: float = 0.0) -> Limited:
        return self.obstacles.limit(linear, angular, self.now)

    def passes(self, linear: float, angular: float = 0.0) -> tuple[float, float]:
        """What comes out of asking for this now."""
        self.judge()
        limited = self.limit(linear, angular)
        return limited.linear_x, limited.angular_z

    def verdict(self, way: str = "forward") -> DirectionLimit:
        judged = getattr(self.judge(), way)
        assert isinstance(judged, DirectionLimit)
        return judged

    def allowed(self, way: str = "forward") -> float:
        return self.verdict(way).allowed


def opened(robot: RobotConfig = ROBOT, config: GuardConfig = CONFIG, distance: float = FAR) -> Senses:
    """At rest, with every sensor proven and nothing held back any more; all have just been heard at `distance`."""
    given = pickle.dumps((robot, config, distance))
    if given not in _OPENED:
        senses = Senses(robot, config)
        senses.cycle(distance, cycles=8)
        senses.hear(distance)
        senses.judge()
        _OPENED[given] = pickle.dumps(senses)
    kept = pickle.loads(_OPENED[given])  # noqa: S301  made here
    assert isinstance(kept, Senses)
    return kept


def echoes_of(senses: Senses) -> Echoes:
    """What is remembered of what was heard."""
    return senses.obstacles._echoes


def beam(
    sensor: str, distance: float, place: Pose = ORIGIN, robot_ns: int = 0, *, mount: Pose = ORIGIN, is_sure: bool = True
) -> Beam:
    """Return an echo that its sensor has heard before; `is_sure`: the time before."""
    return Beam(sensor, mount, HC_SR04.half_cone, robot_ns, place, distance, True, True, is_sure)


def limits(radius: float = ROBOT.footprint_radius) -> Limits:
    return Limits(Live(CONFIG), msgspec.structs.replace(ROBOT, footprint_radius=radius))
