"""Both wheels against a camera: encoders that lose counts alike look sound beside each other.

A robot that holds speeds then drives faster than its wheels say. Only a camera that sees it go farther is a reason for
doubt. One that sees less is no hazard: a wheel may spin, a lens may be dirty.
"""

import math
from collections import deque
from typing import Final, NamedTuple

from giraff_core.counters import restart, signed32
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_WINDOW_NS: Final = 1_000_000_000
"""Least time over which both ways are compared."""
_PAUSE_NS: Final = 300_000_000
"""Time without power, after which the window begins anew: no motor moves the robot then."""
_OLDEST: Final = 0.5  # s from a picture to its word here; an older word is left out
_KEPT: Final = 128  # reports of the wheels: more than _OLDEST of them
_WAY: Final = 0.04
"""m by which the camera may see more, besides its own uncertainty: a key picture's errors and rounded counts."""
_SHARE: Final = 0.15
"""Share of the wheels' way that the camera may see more: by calibrations, or since it was moved a little."""
_DELAY: Final = 0.1  # s by which a picture's moment may be wrong: that counts while the speed changes
_SIGMAS: Final = 3.0
_IN_A_ROW: Final = 3
"""Pictures that must say so: one that is wrong is no reason."""
_DOUBTED: Final = Trouble(
    "encoders of both wheels: the camera saw the robot go farther than they count",
    "check both, and the camera's height in the robot file, then restart giraff_base",
)


class _Rolled(NamedTuple):
    """The wheels' way and speed at one moment."""

    robot_ns: int
    way: float = 0.0
    """m that the middle of the axle has gone, to and fro, by the counts."""
    speed: float = 0.0
    """m/s."""


class _Point(NamedTuple):
    """Both ways at the moment of a sure picture."""

    wheels: _Rolled
    way: float
    """m that the camera has seen."""
    variance: float
    """m², of the key pictures' ways that are over."""
    own: float
    """m², of the way since the key picture."""


class CameraDoubt:
    """Compares the wheels with sure pictures. A doubt lasts until the port is opened anew."""

    def __init__(self, ticks_per_metre: float) -> None:
        self._metres = 0.5 / ticks_per_metre  # of a count of one wheel
        self.forget()

    def forget(self) -> None:
        """Begin anew: the port was opened, perhaps again."""
        self.trouble = NO_TROUBLE
        """Says that the encoders are doubted, and what to do."""
        self._report: Wheels | None = None
        self._powered_ns = 0
        self._rolled: deque[_Rolled] = deque(maxlen=_KEPT)
        self._told: VisualOdometry | None = None
        self._heard_ns = 0
        self._restart()

    def on_wheels(self, report: Wheels) -> None:
        """Take the next report of the wheels."""
        if self._told is None:
            return  # most robots run no camera odometry
        last, self._report = self._report, report
        now_ns, way = report.tick.robot_ns, 0.0
        if last is None or restart(last, report) or now_ns < last.tick.robot_ns:
            self._rolled.clear()
            self._restart()
        else:
            counts = signed32(report.left_ticks - last.left_ticks) + signed32(report.right_ticks - last.right_ticks)
            way = self._rolled[-1].way + abs(counts) * self._metres
        if report.left_pwm_counts or report.right_pwm_counts:
            self._powered_ns = now_ns
        elif now_ns - self._powered_ns > _PAUSE_NS:
            self._points.clear()  # somebody may carry it, or turn the camera
        self._rolled.append(_Rolled(now_ns, way, (report.left_velocity + report.right_velocity) / 2.0))

    def on_camera(self, told: VisualOdometry, now: RobotTime) -> None:
        """Judge the wheels by what the camera says next."""
        last = self._told
        if last is not None and told.instance != last.instance and now.robot_ns - self._heard_ns < _WINDOW_NS:
            return  # of two that speak at once the first one counts, or neither would ever tell of a whole window
        self._told, self._heard_ns = told, now.robot_ns
        if last is None or told.instance != last.instance:
            self._restart()
        elif told.key != last.key:
            # The next key picture is the last one that was told: where that one is not sure, a part of the way is lost.
            follows = told.key == last.key + 1 and told.seq == last.seq + 1
            if follows and _is_sure(last):
                self._way += _way(last)
                self._variance += last.covariance[0]
            else:
                self._restart()
        wheels = self._wheels_at(told, now)
        if wheels is not None and _is_sure(told):
            self._judge(_Point(wheels, self._way + _way(told), self._variance, told.covariance[0]))

    def _restart(self) -> None:
        self._way, self._variance = 0.0, 0.0  # m and m² of the key pictures' ways that are over
        self._points: deque[_Point] = deque()
        self._in_a_row = 0

    def _wheels_at(self, told: VisualOdometry, now: RobotTime) -> _Rolled | None:
        """Return the wheels' way and speed at the picture's moment; None: they are not known, or too old."""
        tick = told.tick
        if tick is None or tick.epoch != now.epoch or not 0.0 <= told.since_tick <= _OLDEST:
            return None
        moment = tick.robot_ns + round(told.since_tick * 1e9)
        if (now.robot_ns - moment) * 1e-9 > _OLDEST:
            return None
        if not self._rolled or moment <= self._rolled[0].robot_ns:
            return None
        after = next((each for each in self._rolled if each.robot_ns >= moment), None)
        return after and after._replace(robot_ns=moment)

    def _judge(self, now: _Point) -> None:
        points = self._points
        if points and now.wheels.robot_ns <= points[-1].wheels.robot_ns:
            return  # said again, or older
        points.append(now)
        while len(points) > 1 and now.wheels.robot_ns - points[1].wheels.robot_ns >= _WINDOW_NS:
            points.popleft()
        then = points[0]
        is_whole = now.wheels.robot_ns - then.wheels.robot_ns >= _WINDOW_NS
        rolled = now.wheels.way - then.wheels.way
        uncertainty = math.sqrt(now.variance - then.variance + now.own + then.own)
        allowed = _WAY + _SHARE * rolled + _DELAY * abs(now.wheels.speed - then.wheels.speed) + _SIGMAS * uncertainty
        self._in_a_row = self._in_a_row + 1 if is_whole and now.way - then.way - rolled > allowed else 0
        if self._in_a_row >= _IN_A_ROW:
            self.trouble = _DOUBTED


def _is_sure(told: VisualOdometry) -> bool:
    """Return whether the picture is sure of its motion. The wheels may say something else."""
    return told.motion is not None and told.covariance[0] > 0.0


def _way(told: VisualOdometry) -> float:
    """Return the m ahead or back since the key picture: no part of a turn."""
    return 0.0 if told.motion is None else abs(told.motion[0])
