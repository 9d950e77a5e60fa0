"""How a motion has ended, as whoever asked for it knows it. No I/O and no clock."""

import math
from typing import Final, Literal

import msgspec

from giraff_schemas.motion import NOWHERE, Displacement, MotionState, Outcome
from giraff_schemas.places import RouteState

NO_WAY: Final = ("no_room", "no_way", "too_narrow", "forbidden")
"""Outcomes of a route whose reasons say where that is."""
_NOTHING: Final = 1e-6
"""m or rad: what sums of steps that take each other back leave over."""

Ending = Outcome | Literal["refused", "unanswered", "unheard", "lost_robot"]
"""As the service that was asked tells it. Or what that cannot tell: it has refused, nobody has answered, what became of
the motion is not heard, the robot is not heard."""


class MotionResult(msgspec.Struct, frozen=True, kw_only=True):
    """How it ended, or how far it was when it was last heard of."""

    outcome: Ending
    begun: bool
    """The service has accepted it; else nothing has moved."""
    reason: str = ""
    """Why it has not arrived, with the way out; empty when it has."""
    sensor: str = ""
    """Which blocks the way; empty: none does."""
    step: int = 0
    """Which of the steps it was at, from 1; 0: none yet."""
    steps: int = 0
    asked: Displacement = NOWHERE
    """m and rad, from where it began."""
    achieved: Displacement = NOWHERE
    """The same, by odometry. Of a route, `asked` and this have the way alone."""
    standard_deviations: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """x (m), y (m) and yaw (rad) of `achieved`: what odometry may err by on this way; of a route, localization's."""
    elapsed: float = 0.0
    """s since it was accepted."""
    place: str | None = None
    """Name of the goal of a route; empty: the goal was a pose; None: no route was heard."""
    at: tuple[float, float] | None = None
    """m, in `map`. What is in the way of a route, or where it has ended; None: nobody tells."""

    @property
    def arrived(self) -> bool:
        """It has done what was asked."""
        return self.outcome == "arrived"

    @property
    def way(self) -> str:
        """Way that it has come, of what was asked, and how sure that is; of a route the first alone."""
        if self.place is not None:
            return way_of(self)
        x_sd, y_sd, yaw_sd = self.standard_deviations
        return f"{way_of(self)}; ± {x_sd:.3f} m ahead, {y_sd:.3f} m aside, {math.degrees(yaw_sd):.1f}° (1 sigma)"


def result_of(state: MotionState | None, outcome: Ending, reason: str, *, begun: bool) -> MotionResult:
    """As far as `state`, the newest of this motion, tells; None: none was heard."""
    if state is None:
        return MotionResult(outcome=outcome, reason=reason, begun=begun)
    is_told = outcome == state.outcome
    route = state if isinstance(state, RouteState) else None
    return MotionResult(
        outcome=outcome,
        begun=begun,
        reason=reason,
        sensor=state.sensor if is_told else "",
        step=state.step,
        steps=state.steps,
        asked=state.asked,
        achieved=state.achieved,
        standard_deviations=state.standard_deviations,
        elapsed=state.elapsed,
        place=route.place if route is not None else None,
        at=route.at if route is not None and is_told else None,
    )


def way_of(at: MotionState | MotionResult) -> str:
    """Return how far it has come, of what was asked: in m along the way, in degrees, or in both."""
    done, asked = at.achieved, at.asked
    if isinstance(at, RouteState) or (isinstance(at, MotionResult) and at.place is not None):
        return f"{done.path:z.1f} of {asked.path:z.1f} m"
    turns = f"{math.degrees(done.yaw):z.1f} of {math.degrees(asked.yaw):z.1f}°"
    way = f"{done.path:z.3f} of {asked.path:z.3f} m"
    if abs(asked.yaw) < _NOTHING:
        return way
    return turns if abs(asked.path) < _NOTHING else f"{way}, {turns}"


def spot_of(at: RouteState | MotionResult) -> str:
    """Return the place of what is in the way of a route, or of its end. Empty: none, or goal or reason say it."""
    if at.at is None or at.outcome in ("arrived", *NO_WAY):
        return ""
    x, y = at.at
    return f"at {x:z.2f},{y:z.2f} m"
