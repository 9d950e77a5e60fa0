"""Where the robot has been in the last moments, and how it leaned: how far it came since a reading."""

from collections import deque
from typing import Final, NamedTuple

from giraff_core.counters import signed32
from giraff_core.freshness import age
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_schemas.messages import Attitude, RobotTime, Wheels

_KEPT_NS: Final = 1_500_000_000
_SLACK: Final = 0.02
"""m added to what a wheel may travel between two reports: counts come whole, and the board's time is not exact."""


class _Moment(NamedTuple):
    robot_ns: int
    place: Pose


class Lean(NamedTuple):
    """How a robot leans about its axle."""

    angle: float
    """rad, forward positive."""
    pivot: float
    """m of the axle above the floor."""


LEVEL: Final = Lean(0.0, 0.0)
"""The lean of a robot on wheels."""


class RecentTravel:
    """Integrates the wheels. Where they are not heard, what was passed on counts as driven."""

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        self._live = live
        self._robot = robot
        self._drive = robot.kinematics
        self._wheels: Wheels | None = None
        self._moments: deque[_Moment] = deque()
        self._leans: deque[tuple[int, Lean]] = deque()
        self._passed: deque[tuple[int, float, float]] = deque()  # (robot_ns, m/s, rad/s), newest last
        self.heard = False
        """Whether the wheels say where the robot is."""
        self.place = Pose(0.0, 0.0, 0.0)
        """Now, in a frame of the guard's own, which drifts as odometry does."""
        self._measured = self.place  # at the newest report
        self.travel = 0.0
        """m the centre has made since the beginning, backwards counted too."""
        self.turned = 0.0
        """rad it has turned since the beginning, either way."""
        self.breaks = 0
        """How often the wheels' counters could not be followed."""

    def on_wheels(self, wheels: Wheels) -> None:
        """Follow a report that is newer than the last."""
        last, self._wheels = self._wheels, wheels
        distance = turn = 0.0
        if last is not None:
            left = signed32(wheels.left_ticks - last.left_ticks) / self._robot.left_ticks_per_metre
            right = signed32(wheels.right_ticks - last.right_ticks) / self._robot.right_ticks_per_metre
            elapsed = ((wheels.board_us - last.board_us) & 0xFFFFFFFF) * 1e-6
            most = 2.0 * self._robot.max_wheel_speed * elapsed + _SLACK
            if (wheels.boot_id, wheels.instance) != (last.boot_id, last.instance) or max(abs(left), abs(right)) > most:
                self.breaks += 1
                self._measured = self.place
            else:
                distance, turn = self._drive.twist(left, right)
        self._measured = self._measured.moved(distance, turn)  # not from where it was reckoned meanwhile
        self._reach(wheels.tick.robot_ns, self._measured, abs(distance), abs(turn))

    def on_attitude(self, attitude: Attitude) -> None:
        """Follow a report that is newer than the last."""
        self._leans.append((attitude.tick.robot_ns, Lean(attitude.lean, attitude.pivot)))
        while self._leans[-1][0] - self._leans[0][0] > _KEPT_NS:
            self._leans.popleft()

    def on_passed(self, linear_x: float, angular_z: float, now: RobotTime) -> None:
        """What the guard lets through from now on."""
        self._passed.append((now.robot_ns, linear_x, angular_z))
        while now.robot_ns - self._passed[0][0] > self._live.config.reaction_time * 1e9 and len(self._passed) > 1:
            self._passed.popleft()

    def update(self, now: RobotTime) -> None:
        """Bring `heard` and `place` up to now."""
        wheels = self._wheels
        self.heard = wheels is not None and age(wheels.tick, now) <= self._live.config.range_budget
        if not self._moments:
            self._moments.append(_Moment(now.robot_ns, self.place))
        seconds = (now.robot_ns - self._moments[-1].robot_ns) * 1e-9
        if self.heard and wheels is not None:
            driving, turning = self._drive.twist(wheels.left_velocity, wheels.right_velocity)
            self.place = self._moments[-1].place.moved(driving * seconds, turning * seconds)
            return
        _, driving, turning = self._passed[-1] if self._passed else (0, 0.0, 0.0)
        self.place = self._moments[-1].place.moved(driving * seconds, turning * seconds)
        self._reach(now.robot_ns, self.place, abs(driving * seconds), abs(turning * seconds))

    def place_at(self, robot_ns: int) -> Pose:
        """Where the robot was; the oldest place that is known for what lies before it."""
        later: _Moment | None = None
        for moment in reversed(self._moments):
            if moment.robot_ns <= robot_ns:
                if later is None:
                    return moment.place
                share = (robot_ns - moment.robot_ns) / (later.robot_ns - moment.robot_ns)
                here, there = moment.place, later.place
                return Pose(*(a + (b - a) * share for a, b in zip(here, there, strict=True)))
            later = moment
        return later.place if later else self.place

    def lean_at(self, robot_ns: int) -> Lean | None:
        """Return how the robot leaned, LEVEL on wheels; None: no report within `range_budget` tells.

        A robot with a `run_on` balances, so its lean is not known before its first report.
        """
        later: tuple[int, Lean] | None = None
        leans = bool(self._leans) or self._live.config.run_on > 0.0
        found: Lean | None = None if leans else LEVEL
        for at_ns, lean in reversed(self._leans):
            if at_ns <= robot_ns:
                if (robot_ns - at_ns) * 1e-9 > self._live.config.range_budget:
                    return None
                if later is None:
                    return lean
                share = (robot_ns - at_ns) / (later[0] - at_ns)
                return Lean(lean.angle + (later[1].angle - lean.angle) * share, lean.pivot)
            later = at_ns, lean
            found = lean if (at_ns - robot_ns) * 1e-9 <= self._live.config.range_budget else None
        return found

    def speed(self, sign: float) -> float:
        """m/s the robot does forward (1) or backward (-1), never negative: the larger of measured and commanded.

        What was passed on counts once it has been in force for the reaction time. Where the wheels are not heard, it
        counts from the beginning, and as long.
        """
        passed = [max(0.0, sign * linear) for _, linear, _ in self._passed]
        if self.heard and self._wheels is not None:
            driving, _ = self._drive.twist(self._wheels.left_velocity, self._wheels.right_velocity)
            measured = sign * driving
            return max(measured, min(passed, default=0.0))
        return max(passed, default=0.0)

    def _reach(self, robot_ns: int, place: Pose, distance: float, turn: float) -> None:
        self.place = place
        self.travel += distance
        self.turned += turn
        if self._moments and robot_ns <= self._moments[-1].robot_ns:
            robot_ns = self._moments.pop().robot_ns
        self._moments.append(_Moment(robot_ns, place))
        while robot_ns - self._moments[0].robot_ns > _KEPT_NS:
            self._moments.popleft()
