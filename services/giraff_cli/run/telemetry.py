"""What is heard and seen of a run: the robot as any is heard, and beside it the world's truth."""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_core.latest import Latest
from giraff_core.senses import SENSED
from giraff_maps.room_file import Point
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import GuardedCommand, Odometry, RobotTime, Sample, TruePose
from giraff_schemas.topics import ODOM, POSE, TICK, TILT, VISUAL_ODOM, WHEELS, Topic
from giraff_sim.bodies.registry import DrawnBody
from giraff_sim.world.body import Balance
from giraff_telemetry.collector import Snapshot, Telemetry
from giraff_telemetry.localization import WayByState
from giraff_telemetry.localization_error import LocalizationError, LocalizationErrors
from giraff_telemetry.localization_summary import LocalizationSummary, summarize_localization
from giraff_telemetry.visual_odometry import VisualErrors, VisualSummary
from giraff_tools.network.statistics import AgeHistogram

_KEPT: Final = 200  # odometry samples: two seconds, more than lie between two looks at the truth
_REST: Final = 1e-3  # m/s, rad/s


@dataclass(frozen=True)
class Truth:
    """The simulated robot as the world has it."""

    robot_ns: int
    """Robot's clock when the world was asked."""
    simulated_us: int
    pose: Pose
    speed: float
    """m/s, forward positive."""
    turn: float
    """rad/s, counter-clockwise positive."""
    path: float
    """m that the robot's centre has moved."""
    closest: float
    """m; the smallest clearance to anything so far."""
    contacts: int
    """How often the robot came to touch something."""
    balance: Balance | None = None
    """Of a robot that can fall over. Such a one is never quite still."""
    drawn: DrawnBody | None = None
    """How its body differs from its file, where the simulator's truth does not say it."""

    @property
    def is_at_rest(self) -> bool:
        if self.balance is not None:
            return self.balance.is_settled
        return abs(self.speed) < _REST and abs(self.turn) < _REST


class OdometryError(NamedTuple):
    """Odometry's error at one moment."""

    distance: float
    """m."""
    angle: float
    """rad, never negative."""
    x: float = 0.0
    """m that odometry is too far along the axis of its frame."""
    y: float = 0.0
    """The same of the other axis."""


class Comparison:
    """Odometry against the truth at the same moment, each from where it was when both were first known.

    The two are not heard at the same moments: odometry is interpolated to the moment of each truth, as soon as
    samples from both sides of it are there.
    """

    def __init__(self) -> None:
        self.apart: OdometryError | None = None
        """At the newest truth that odometry reaches up to; None: at none of late."""
        self._samples: deque[Odometry] = deque(maxlen=_KEPT)
        self._waiting: Truth | None = None
        self._origins: tuple[Pose, Pose] | None = None

    def on_sample(self, sample: Odometry) -> None:
        if self._samples and self._samples[-1].segment != sample.segment:
            # A restarted odometry begins anew wherever the robot then is, one whose pose was set goes on from there.
            self._samples.clear()
            self._origins = None
        self._samples.append(sample)

    def see(self, truth: Truth) -> None:
        if self._waiting is not None:
            odometry = self._at(self._waiting.robot_ns)
            self.apart = None if odometry is None else self._compare(odometry, self._waiting.pose)
        self._waiting = truth

    def in_odom(self, truth: Pose) -> Pose | None:
        """A true pose in the frame of odometry; None: odometry has not begun."""
        if self._origins is None:
            return None
        odometry, origin = self._origins
        return truth.seen_from(origin).placed_in(odometry)

    def _compare(self, odometry: Pose, truth: Pose) -> OdometryError:
        if self._origins is None:
            self._origins = odometry, truth
        true = self.in_odom(truth) or odometry
        x, y = odometry.x - true.x, odometry.y - true.y
        return OdometryError(math.hypot(x, y), abs(odometry.seen_from(true).yaw), x, y)

    def _at(self, robot_ns: int) -> Pose | None:
        later: Odometry | None = None
        for sample in reversed(self._samples):
            if sample.tick.robot_ns <= robot_ns:
                return None if later is None else _between(sample, later, robot_ns)
            later = sample
        return None


def _between(before: Odometry, after: Odometry, robot_ns: int) -> Pose:
    share = (robot_ns - before.tick.robot_ns) / (after.tick.robot_ns - before.tick.robot_ns)
    return Pose(before.x, before.y, before.yaw).towards(Pose(after.x, after.y, after.yaw), share)


_BY_BOARD: Final = {topic.key for topic in (TILT, *SENSED.values(), WHEELS, ODOM)}
"""What the boards' clocks pace: judged in simulated time, in which all three agree. The rest goes by the wall's."""


@dataclass(frozen=True)
class AgeSummary:
    """Of commands when they reached base's host, ms."""

    p50: float
    p99: float
    max: float


@dataclass(frozen=True, kw_only=True)
class RunSnapshot(Snapshot):
    """A run at one moment."""

    truth: Truth
    true_pose: Pose | None
    """The truth in the frame of odometry."""
    apart: OdometryError | None
    age_ms: AgeSummary | None
    off_map: LocalizationError | None
    """Localization's error at its newest pose that the truth reaches up to."""
    seen: Latest[VisualOdometry] | None
    """What giraff_vision said last."""


class RunTelemetry(Telemetry):
    """Collects, on base's host: times are the robot's clock in ns."""

    def __init__(
        self, sensors: Mapping[str, str], truth: Truth, room: Sequence[Sequence[Point]] = (), name: str | None = None
    ) -> None:
        """`truth`: from before anything is heard. `room`: lines that show what stands in it, m.

        `name`: of the room, whose frame is that of the map of this name; None: of any map.
        """
        super().__init__(sensors)
        self.truth = truth
        self._room, self._room_name = room, name
        self._first_truth = truth
        self._comparison = Comparison()
        self._stood_at: Pose | None = None
        self._stood: Balance | None = None
        self.drift = 0.0
        """m. The farthest that a robot that balances came from where it had settled, before it drove or was pushed."""
        self._ages = AgeHistogram()
        self._map_errors, self._map_way = LocalizationErrors(), WayByState()
        self._visual = VisualErrors()

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        super().on_sample(topic, key, sample, at_ns)
        if isinstance(sample, Odometry):
            self._comparison.on_sample(sample)
            self._visual.on_odometry(sample)
        elif isinstance(sample, VisualOdometry):
            self._visual.on_sample(sample)
        elif isinstance(sample, MapPose):
            if self._room_name is None or sample.map == self._room_name:
                self._map_errors.on_pose(sample)
        elif isinstance(sample, GuardedCommand):
            self._note_age(sample, at_ns)

    def begin(self) -> None:
        """Judge rates and skew from now on: while processes start, nothing has its rate."""
        super().begin()
        self._first_truth = self.truth

    def see(self, truth: Truth) -> None:
        """The world's truth."""
        self.truth = truth
        self._comparison.see(truth)
        self._see_drift(truth)
        self._map_errors.see(truth.robot_ns, truth.pose)
        self._visual.see(truth.robot_ns, truth.pose, truth.path)
        said = self.latest(POSE, truth.robot_ns)
        self._map_way.come(truth.path, said.sample.state if said is not None and said.fresh else None)

    def sit(self) -> None:
        """A robot that balances sits down from now on. That is no fall."""
        self._stood = self.truth.balance

    @property
    def balance(self) -> Balance | None:
        """How a robot that balances stood, before it was made to sit down."""
        return self._stood or self.truth.balance

    @property
    def is_at_rest(self) -> bool:
        return self.truth.is_at_rest and (self._stood is None or self.has_sat_down)

    @property
    def has_sat_down(self) -> bool:
        return self._stood is not None and self.truth.balance is not None and not self.truth.balance.stands

    def _see_drift(self, truth: Truth) -> None:
        if truth.balance is None or self._stood is not None or not truth.is_at_rest:
            self._stood_at = None
            return
        self._stood_at = self._stood_at or truth.pose
        away = math.hypot(truth.pose.x - self._stood_at.x, truth.pose.y - self._stood_at.y)
        self.drift = max(self.drift, away)

    @property
    def apart(self) -> OdometryError | None:
        """Odometry's error now."""
        return self._comparison.apart

    @property
    def localization(self) -> LocalizationSummary | None:
        """How well it knew where it was on the map; None: nothing was heard of that."""
        said = self.latest(POSE, self.truth.robot_ns)
        return None if said is None else summarize_localization(said.sample, self._map_way, self._map_errors)

    @property
    def visual(self) -> VisualSummary | None:
        """Return how well the camera saw the robot's motion. None: nothing was heard of giraff_vision."""
        return self._visual.summary

    @property
    def true_pose(self) -> TruePose | None:
        """As it is told to whoever looks on; None: before odometry has begun."""
        tick, pose = self.latest(TICK, self.truth.robot_ns), self._comparison.in_odom(self.truth.pose)
        if tick is None or pose is None:
            return None
        at = RobotTime(epoch=tick.sample.epoch, robot_ns=self.truth.robot_ns)
        return TruePose(x=pose.x, y=pose.y, yaw=pose.yaw, tick=at)

    def walls(self) -> tuple[tuple[Point, ...], ...]:
        """Return the lines of the room in the frame of odometry. Empty before odometry has begun."""
        lines = [[self._comparison.in_odom(Pose(x, y, 0.0)) for x, y in line] for line in self._room]
        return tuple(tuple((place.x, place.y) for place in line if place is not None) for line in lines if line[0])

    @property
    def skew(self) -> float:
        """How much slower simulated time went than the wall's, as a share; negative: faster."""
        wall_us = (self.truth.robot_ns - self._first_truth.robot_ns) / 1000
        return 1.0 - (self.truth.simulated_us - self._first_truth.simulated_us) / wall_us if wall_us else 0.0

    @property
    def age_ms(self) -> AgeSummary | None:
        p50, p99, most = self._ages.quantile(0.5), self._ages.quantile(0.99), self._ages.quantile(1.0)
        return None if p50 is None or p99 is None or most is None else AgeSummary(p50, p99, most)

    def snapshot(self, now_ns: int) -> RunSnapshot:
        return RunSnapshot(
            **vars(super().snapshot(now_ns)),
            truth=self.truth,
            true_pose=self._comparison.in_odom(self.truth.pose),
            apart=self.apart,
            age_ms=self.age_ms,
            off_map=self._map_errors.newest,
            seen=self.latest(VISUAL_ODOM, now_ns),
        )

    def _clock(self, topic: Topic[Any], at_ns: int) -> float:
        """s of the clock that paces a topic. Simulated time runs on from the last look at it."""
        if topic.key in _BY_BOARD:
            return self.truth.simulated_us * 1e-6 + (at_ns - self.truth.robot_ns) * 1e-9
        return super()._clock(topic, at_ns)

    def _note_age(self, command: GuardedCommand, at_ns: int) -> None:
        tick = self.latest(TICK, at_ns)
        if tick is None or command.operator_tick is None or command.source != "hand":
            return
        if tick.sample.epoch == command.operator_tick.epoch:
            self._ages.add((at_ns - command.operator_tick.robot_ns) * 1e-6)
