"""How well a camera saw the robot's motion, beside the wheels and the truth. SI units where no field says otherwise."""

import math
from collections import Counter, deque
from itertools import pairwise
from typing import Final, NamedTuple

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_core.latest import Latest
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import Odometry
from giraff_schemas.text import printable

_KEPT: Final = 500
"""Samples of each kind: 5 s of odometry, longer than a picture and a look at the truth take to come."""
_TRUTHS: Final = 50
"""Looks at the truth: 10 s. On a busy machine a picture comes long after the next look."""
_TOLD: Final = 3
"""Reasons; the others are counted together."""
_NOWHERE: Final = Pose(0.0, 0.0, 0.0)


class VisualSummary(msgspec.Struct, frozen=True, kw_only=True):
    """Everything counts from the first picture that giraff_vision saw since its start."""

    camera: str
    pictures: int
    """Pictures after the first."""
    measured_share: float
    """Share of them that are measurements, 0..1."""
    reasons: dict[str, int]
    """Pictures that are none, by the reason; the most frequent first."""
    without_wheels: int
    """Pictures at which the wheels were not heard. Nothing contradicts these, and the path may lack their motion."""
    path_m: float
    """m of the way by the picture and, where that is no measurement, by the wheels."""
    blind_m: float
    """m of it that are the wheels' word."""
    true_m: float | None
    """m that the robot truly moved; None: the truth of no picture is known."""
    error_m: float | None
    """m between the place by the picture and the true one, at the end."""
    error_deg: float | None
    wheels_m: float | None
    """m of the way by odometry; None: it began anew meanwhile, or its place was set."""
    wheels_error_m: float | None
    wheels_error_deg: float | None


class _Moment(NamedTuple):
    """Where the robot was at one picture."""

    seen: VisualOdometry
    truth: Pose
    true_path: float
    """m."""
    odometry: Odometry | None
    """The newest of that moment."""
    wheels: Pose
    """By it, at the moment."""


class VisualErrors:
    """Each picture's path against truth and wheels at the picture's own moment."""

    def __init__(self) -> None:
        self._begin()
        self._odometry: deque[Odometry] = deque(maxlen=_KEPT)
        self._truths: deque[tuple[int, Pose, float]] = deque(maxlen=_TRUTHS)

    def _begin(self) -> None:
        self._newest: VisualOdometry | None = None
        self._waiting: deque[VisualOdometry] = deque(maxlen=_KEPT)
        self._first: _Moment | None = None
        self._last: _Moment | None = None
        self._pictures = self._without_wheels = 0
        self._reasons: Counter[str] = Counter()

    def on_odometry(self, sample: Odometry) -> None:
        """Take what the wheels say next."""
        self._odometry.append(sample)

    def on_sample(self, sample: VisualOdometry) -> None:
        """Take what giraff_vision says next. One that has started again begins anew."""
        if self._newest is None or self._newest.instance != sample.instance:
            self._begin()
        else:
            self._pictures += 1
            self._without_wheels += sample.wheels is None
            if sample.reason:
                self._reasons[sample.reason.what] += 1
        self._newest = sample
        self._waiting.append(sample)

    def see(self, robot_ns: int, truth: Pose, path: float) -> None:
        """Take where the robot truly is and how far it came, at a later moment of the robot's clock than before."""
        self._truths.append((robot_ns, truth, path))
        while self._waiting:
            sample = self._waiting[0]
            at_ns = None if sample.tick is None else sample.tick.robot_ns + round(sample.since_tick * 1e9)
            if at_ns is not None and at_ns > robot_ns:
                return
            self._waiting.popleft()
            if at_ns is not None and (true := self._true_at(at_ns)) is not None:
                self._last = _Moment(sample, *true, *self._wheels_at(at_ns))
                self._first = self._first or self._last

    def _true_at(self, robot_ns: int) -> tuple[Pose, float] | None:
        for (begin_ns, begin, path), (end_ns, end, end_path) in pairwise(self._truths):
            if begin_ns <= robot_ns <= end_ns and begin_ns < end_ns:
                share = (robot_ns - begin_ns) / (end_ns - begin_ns)
                return begin.towards(end, share), path + share * (end_path - path)
        return None

    def _wheels_at(self, robot_ns: int) -> tuple[Odometry | None, Pose]:
        odometry = next((each for each in reversed(self._odometry) if each.tick.robot_ns <= robot_ns), None)
        if odometry is None:
            return None, _NOWHERE
        seconds = (robot_ns - odometry.tick.robot_ns) * 1e-9
        pose = Pose(odometry.x, odometry.y, odometry.yaw)
        return odometry, pose.moved(odometry.linear_x * seconds, odometry.angular_z * seconds)

    @property
    def summary(self) -> VisualSummary | None:
        """The numbers so far. None: nothing was heard of giraff_vision."""
        newest, begin, end = self._newest, self._first, self._last
        if newest is None:
            return None
        true_m = error = wheels_m = wheels_error = None
        if begin is not None and end is not None:
            true_m = round(end.true_path - begin.true_path, 4)
            motion = end.truth.seen_from(begin.truth)
            error = _apart(Pose(*end.seen.path).seen_from(Pose(*begin.seen.path)), motion)
            before, after = begin.odometry, end.odometry
            if before is not None and after is not None and before.segment == after.segment:
                wheels_m = round(after.path - before.path, 4)
                wheels_error = _apart(end.wheels.seen_from(begin.wheels), motion)
        return VisualSummary(
            camera=newest.camera,
            pictures=self._pictures,
            measured_share=round(1.0 - self._reasons.total() / self._pictures, 4) if self._pictures else 0.0,
            reasons=dict(self._reasons.most_common()),
            without_wheels=self._without_wheels,
            path_m=round(newest.seen_m + newest.blind_m, 4),
            blind_m=round(newest.blind_m, 4),
            true_m=true_m,
            error_m=None if error is None else error[0],
            error_deg=None if error is None else error[1],
            wheels_m=wheels_m,
            wheels_error_m=None if wheels_error is None else wheels_error[0],
            wheels_error_deg=None if wheels_error is None else wheels_error[1],
        )


def visual_text(seen: Latest[VisualOdometry]) -> str:
    """Return whether the camera measures the motion now, or why it does not."""
    if not seen.fresh:
        return f"unknown, vision was not heard for {seen.age:.0f} s"
    return seen.sample.reason.what or "measures"


def visual_rows(summary: VisualSummary) -> list[tuple[str, str]]:
    """Return rows for people: labels of at most 15 characters, and values."""
    ways = f"truth {_way(summary.true_m)}, wheels {_way(summary.wheels_m)}, camera {summary.path_m:.2f} m"
    blind = f", all but {summary.blind_m:.2f} m of the way" if summary.blind_m else ""
    why = [f"\n{count} {printable(what)}" for what, count in [*summary.reasons.items()][:_TOLD]]
    rest = sum([*summary.reasons.values()][_TOLD:])
    why += [f"\n{rest} for other reasons"] if rest else []
    alone = f"\nnothing heard of the wheels at {summary.without_wheels}" if summary.without_wheels else ""
    share = f"{summary.measured_share:.1%} of {summary.pictures} pictures{blind}"
    return [
        ("since a picture", ways),
        ("wheels off by", _off(summary.wheels_error_m, summary.wheels_error_deg, summary.true_m)),
        ("camera off by", _off(summary.error_m, summary.error_deg, summary.true_m)),
        ("camera measures", "".join([share, "; else" if why else "", *why, alone])),
    ]


def _way(metres: float | None) -> str:
    return "unknown" if metres is None else f"{metres:.2f} m"


def _off(metres: float | None, degrees: float | None, way: float | None) -> str:
    if metres is None or degrees is None:
        return "unknown"
    return f"{metres:.3f} m, {degrees:.2f}°" + (f" ({metres / way:.2%} of the way)" if way else "")


def _apart(one: Pose, other: Pose) -> tuple[float, float]:
    """Return m and degrees."""
    off = one.seen_from(other)
    return round(math.hypot(off.x, off.y), 4), round(abs(math.degrees(off.yaw)), 3)
