"""How a motion has ended, as whoever asked for it knows it. No I/O and no clock."""

import math
from typing import Final, Literal

import msgspec

from giraff_schemas.motion import NOWHERE, Displacement, MotionState, Outcome

_NOTHING: Final = 1e-6
"""m or rad: what sums of steps that take each other back leave over."""

Ending = Outcome | Literal["refused", "unanswered", "unheard", "lost_robot"]
"""As `giraff_motion` tells it. Or what it cannot tell: it has refused, nobody has answered, what became of it is not
heard, the robot is not heard."""


class MotionResult(msgspec.Struct, frozen=True, kw_only=True):
    """How it ended, or how far it was when it was last heard of."""

    outcome: Ending
    begun: bool
    """giraff_motion has accepted it; else nothing has moved."""
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
    """The same, by odometry."""
    standard_deviations: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of `achieved`: x (m), y (m), yaw (rad), what odometry may err by on this way."""
    elapsed: float = 0.0
    """s since it was accepted."""

    @property
    def arrived(self) -> bool:
        """It has done what was asked."""
        return self.outcome == "arrived"

    @property
    def way(self) -> str:
        """How far it has come, of what was asked, and how sure that is."""
        x_sd, y_sd, yaw_sd = self.standard_deviations
        return f"{way_of(self)}; ± {x_sd:.3f} m ahead, {y_sd:.3f} m aside, {math.degrees(yaw_sd):.1f}° (1 sigma)"


def result_of(state: MotionState | None, outcome: Ending, reason: str, *, begun: bool) -> MotionResult:
    """As far as `state`, the newest of this motion, tells; None: none was heard."""
    if state is None:
        return MotionResult(outcome=outcome, reason=reason, begun=begun)
    return MotionResult(
        outcome=outcome,
        begun=begun,
        reason=reason,
        sensor=state.sensor if outcome == state.outcome else "",
        step=state.step,
        steps=state.steps,
        asked=state.asked,
        achieved=state.achieved,
        standard_deviations=state.standard_deviations,
        elapsed=state.elapsed,
    )


def way_of(at: MotionState | MotionResult) -> str:
    """How far it has come, of what was asked: in m along the way, in degrees, or in both."""
    done, asked = at.achieved, at.asked
    turns = f"{math.degrees(done.yaw):z.1f} of {math.degrees(asked.yaw):z.1f}°"
    way = f"{done.path:z.3f} of {asked.path:z.3f} m"
    if abs(asked.yaw) < _NOTHING:
        return way
    return turns if abs(asked.path) < _NOTHING else f"{way}, {turns}"
