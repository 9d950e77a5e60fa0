"""Motions by metres and radians, and routes, from a script: the robot drives, and the script holds on to it."""

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import closing
from typing import Literal

import zenoh

from giraff_client.errors import LostRobotError, MotionBlockedError, MotionError, SilentError
from giraff_client.reading import require_finite
from giraff_core.motion.result import MotionResult
from giraff_core.motion.wish import RouteWish, Wish
from giraff_node.motion_client import TURN, MotionClient
from giraff_schemas.motion import Arc, GoTo, Move, Step, Turn
from giraff_schemas.places import require_place_name


class Motions(ABC):
    """Each call is a wish of its own: it arms the robot, drives it, and returns when it has arrived.

    Whatever else ends it raises: MotionBlockedError before an obstacle, MotionError with its `result` for all that
    giraff_motion tells, SilentError where no giraff_motion answers, LostRobotError, NoRobotError, ValueError for what
    is no number. Ctrl-C stops the robot, and then raises as ever. A robot that nobody has named takes a typed yes, as
    of `arm`.
    """

    def move(self, distance: float, *, speed: float | None = None, time_limit: float | None = None) -> MotionResult:
        """Straight on, m, negative for backward; at `speed` m/s at most, and no longer than `time_limit` s."""
        require_finite("move", "m, m/s and s", distance, *_given(speed, time_limit))
        return self.go([Move(distance=float(distance))], speed=speed, time_limit=time_limit)

    def turn(self, angle: float, *, speed: float | None = None, time_limit: float | None = None) -> MotionResult:
        """On the spot, rad, left positive, any number of turns; at `speed` rad/s at most."""
        require_finite("turn", "rad, rad/s and s", angle, *_given(speed, time_limit))
        return self.go([Turn(angle=float(angle))], turn_speed=speed, time_limit=time_limit)

    def arc(
        self, radius: float, angle: float, *, speed: float | None = None, time_limit: float | None = None
    ) -> MotionResult:
        """Forward along a circle, m and rad: its middle is to the left for a positive angle, else to the right."""
        require_finite("arc", "m, rad, m/s and s", radius, angle, *_given(speed, time_limit))
        return self.go([Arc(radius=float(radius), angle=float(angle))], speed=speed, time_limit=time_limit)

    def go_to(
        self,
        x: float,
        y: float,
        *,
        frame: Literal["odom", "map"] = "odom",
        speed: float | None = None,
        turn_speed: float | None = None,
        time_limit: float | None = None,
    ) -> MotionResult:
        """Turn to a point of `frame`, m, and go straight to it. No way around anything is planned.

        One of `map` is gone to only while the robot is localized: where it is not, or that is over, MotionError says
        why, and its result's `outcome` is `refused` or `lost_localization`.
        """
        require_finite("go_to", "m, m, m/s, rad/s and s", x, y, *_given(speed, turn_speed, time_limit))
        if frame not in ("odom", "map"):
            raise ValueError(f"go_to: there are the frames 'odom' and 'map', and not {frame!r}")
        return self.go(
            [GoTo(x=float(x), y=float(y), frame=frame)], speed=speed, turn_speed=turn_speed, time_limit=time_limit
        )

    def go(
        self,
        goal: str | Sequence[Step],
        *,
        speed: float | None = None,
        turn_speed: float | None = None,
        time_limit: float | None = None,
    ) -> MotionResult:
        """To a place of the floor plan by its name, or by steps, one after the other, as one motion.

        To a place giraff_places finds a way, which goes as the robot file has it: it takes no speed and no time limit.
        MotionBlockedError says that something is in the way and stays there, and MotionError all else: its result's
        `outcome` may also be `no_room`, `no_way`, `too_narrow` or `forbidden`, and of an unknown name it is `refused`.

        Each step begins where the one before it was to end.

        A script that drove by `drive` lets go first, which takes about a second; its next `drive` arms anew. After a
        motion that did not arrive it must call `arm` for that, unless its way or its time was at an end.
        """
        require_finite("go", "m/s, rad/s and s", *_given(speed, turn_speed, time_limit))
        wish: Wish | RouteWish
        if isinstance(goal, str):
            if _given(speed, turn_speed, time_limit):
                raise ValueError(
                    f"go({goal!r}): a route goes as the robot file has it; give no speed and no time limit"
                )
            wish = RouteWish(require_place_name(goal))
        else:
            _require_steps(goal)
            steps = tuple(goal)
            limits = [None if limit is None else float(limit) for limit in (speed, turn_speed, time_limit)]
            wish = Wish(steps, *limits)
        session, name, by, patience = self._begin_motion()
        client = MotionClient(session, name, by, wish)
        with closing(client):
            result = _followed(client, patience)
        self._end_motion(result)
        if result.arrived:
            return result
        raise _error_of(result)

    @abstractmethod
    def _begin_motion(self) -> tuple[zenoh.Session, str, str, float]:
        """Let go of the robot. Session, robot, whom to name, s of patience. Raises RobotError."""

    @abstractmethod
    def _end_motion(self, result: MotionResult) -> None:
        """Take how it ended."""


def _require_steps(steps: object) -> None:
    if not isinstance(steps, Sequence) or not all(isinstance(step, Step) for step in steps):
        raise ValueError(f"go({steps}): each step must be a Move, a Turn, an Arc or a GoTo")


def _given(*values: float | None) -> list[float]:
    return [value for value in values if value is not None]


def _followed(client: MotionClient, patience: float) -> MotionResult:
    """Until it has ended. Raises LostRobotError where the robot is not heard at all."""
    until = time.monotonic() + patience
    try:
        while (result := client.turn(now := time.monotonic())) is None:
            if not client.has_asked and now > until:
                raise LostRobotError(
                    "no tick of the robot; check that base runs and that both machines share a network"
                )
            time.sleep(TURN)
    except KeyboardInterrupt:
        client.cancel(time.monotonic())
        while client.turn(time.monotonic()) is None:
            time.sleep(TURN)
        raise
    return result


def _error_of(result: MotionResult) -> MotionError | SilentError | LostRobotError:
    match result.outcome:
        case "blocked":
            return MotionBlockedError(result)
        case "unanswered":
            return SilentError(result.reason)
        case "lost_robot":
            return LostRobotError(result.reason)
        case _:
            return MotionError(result)
