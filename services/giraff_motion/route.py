"""The way of one motion, piece by piece: a step in `map` is placed in `odom` when it begins."""

from collections.abc import Iterable

from giraff_core.kinematics.pose import Pose
from giraff_motion.legs import Limits, Plan, Planned, plan
from giraff_motion.localized import Correction, Localized, Placed, is_in_map
from giraff_schemas.motion import Step


class Route:
    """Begins before its first piece."""

    def __init__(self, steps: Iterable[Step], start: Pose, floor: Limits, spot: Limits, localized: Localized) -> None:
        """Raises ValueError where these steps are none. While `needs_map`, `localized` may have no fault."""
        self._steps = tuple(steps)
        self._last_in_map = max((number for number, step in enumerate(self._steps, 1) if is_in_map(step)), default=0)
        self._limits = floor, spot
        self._localized = localized
        whole = self._plan(1, start)
        if not whole.legs:
            raise ValueError("this asks for no motion: the robot is there")
        self.asked = whole.asked
        self.legs = whole.legs
        self.steps = whole.legs[-1].step
        """How many there are."""
        self.at = -1
        """Index of the piece."""
        self.placed: Placed | None = None
        """Where the goal of this step is; None: it is none of `map`."""
        self._known = start
        """Where `odom` was in `map` by the newest word."""
        self._begun = 0
        """The step that has begun last, from 1; 0: the one that it is at is to begin anew."""

    @property
    def is_done(self) -> bool:
        return self.at >= len(self.legs)

    @property
    def step(self) -> int:
        """That it is at, from 1; the last one when it is done."""
        return self.steps if self.is_done else self.legs[max(0, self.at)].step

    @property
    def needs_map(self) -> bool:
        """Whether this step or one to come is in `map`."""
        return not self.is_done and self.step <= self._last_in_map

    def next(self, here: Pose) -> Planned | None:
        """The next piece, for a robot that rests here; None: that was the last."""
        self.at += 1
        while not self.is_done and self.step != self._begun:
            self._begin(self.step, here)
        return None if self.is_done else self.legs[self.at]

    def jump(self, odom: Pose, here: Pose) -> Correction | None:
        """What has moved goal or robot at once, now that `odom` is there in `map`; None: nothing by so much."""
        if self.placed is None:
            return None
        jumped = self.placed._replace(odom=self._known).correction(odom, here)
        self._known = odom
        return jumped if jumped.is_large else None

    def is_off(self, odom: Pose, here: Pose) -> bool:
        """Whether the goal of this step is to be placed anew, by all corrections since it was; then `next` does."""
        if self.placed is None or not self.placed.correction(odom, here).is_large:
            return False
        self._begun = 0
        self.at -= 1
        return True

    def _begin(self, number: int, here: Pose) -> None:
        """Take a step up; it may be at its end by now, where it is in `map`."""
        self._begun, self.placed = number, None
        if is_in_map(step := self._steps[number - 1]):
            self.placed = self._localized.placed(step)
            self._known = self.placed.odom
            self.legs = (*self.legs[: self.at], *self._plan(number, here).legs)

    def _plan(self, first: int, here: Pose) -> Plan:
        """From this step on."""
        steps = (self._localized.placed(step).goal if is_in_map(step) else step for step in self._steps[first - 1 :])
        return plan(steps, here, *self._limits, first)
