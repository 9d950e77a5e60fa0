"""A floor plan as the filter needs it: where a robot can be, and what it would hear there."""

from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_core.robot import RobotConfig
from giraff_core.senses import HC_SR04, Ultrasonic
from giraff_localization.config import LocalizationConfig
from giraff_localization.free_space import FreeSpace
from giraff_localization.range_table import CLEAR, SLANTED, SOLID, Cone, RangeTable
from giraff_maps.floor_plan import FloorPlan, MapError

_BODY: Final = 0.7
"""Of the footprint's radius: a map is not exact, and a robot that touches furniture is somewhere all the same."""
_LARGEST: Final = 2000.0
"""m² of the rectangle about the plan: the table has 29 kB for each m²."""
_SMALLEST: Final = 0.5
"""m² where the robot's middle can be."""

_HIT: Final = 0.72
_NEARER: Final = 0.10
_WILD: Final = 0.10
_LOST: Final = 0.08
_SPREAD: Final = 0.15
"""m, standard deviation of an echo: of the map and of furniture, far more than the sensor's own."""
_SURPRISE: Final = 0.15
"""Share of echoes where nothing is on the map."""
_SLANTED_CLEAR: Final = 0.45
"""Share of no echo from what is too slanted."""
_SOLID: Final = 0.02
"""Of each reading of a sensor that would be within a wall."""
_NEAR: Final = 0.3
"""m: an echo of something nearer than a wall is taken to come from so much of room at least."""


def beam_model(reach: float, bin_size: float) -> npt.NDArray[np.float32]:
    """log p(reading | expected), by reading (a range in bins, or CLEAR) and by expected; of echoes: per m.

    A mixture as in S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), section 6.3: the expected echo, one of
    something nearer that is not on the map, one of no meaning, and none at all. Where no echo is expected, that there
    is none is a reading of its own, with its own likelihood. `reach`, `bin_size`: m.
    """
    bins = np.arange(CLEAR) * bin_size
    likely = np.full((SOLID + 1, SOLID + 1), _SOLID / reach)
    echo, none = slice(0, CLEAR), CLEAR
    off = (bins[:, None] - bins[None, :]) / _SPREAD
    nearer = (bins[:, None] < bins[None, :]) / np.maximum(bins[None, :], _NEAR)
    hit = np.exp(-0.5 * off * off) / (_SPREAD * np.sqrt(2.0 * np.pi))
    likely[echo, echo] = _HIT * hit + _NEARER * nearer + _WILD / reach
    likely[none, echo] = _LOST
    likely[echo, CLEAR], likely[none, CLEAR] = _SURPRISE / reach, 1.0 - _SURPRISE
    likely[echo, SLANTED], likely[none, SLANTED] = (1.0 - _SLANTED_CLEAR) / reach, _SLANTED_CLEAR
    likely[none, SOLID] = _SOLID
    model: npt.NDArray[np.float32] = np.log(likely).astype(np.float32)
    return model


class Floor:
    """Raises MapError for a plan that no robot of this size drives on. Of no use until it is built."""

    def __init__(self, plan: FloorPlan, config: LocalizationConfig, robot: RobotConfig) -> None:
        footprint_radius = robot.footprint_radius
        self.plan = plan
        self.is_built = False
        bounds = plan.bounds
        width, depth = bounds.right - bounds.left, bounds.top - bounds.bottom
        if width * depth > _LARGEST:
            raise MapError(
                f"the map {plan.name!r} is {width:.0f} m by {depth:.0f} m, more than {_LARGEST:.0f} m²: is it in "
                "metres? Give it the part where the robot drives"
            )
        self.space = FreeSpace(plan, _BODY * footprint_radius)
        if self.space.area < _SMALLEST:
            raise MapError(
                f"the map {plan.name!r}, {width:.2f} m by {depth:.2f} m, has no room for a robot of "
                f"{2.0 * footprint_radius:.2f} m across: is it in metres?"
            )
        cone = _cone(config, robot)
        self.reach = cone.reach
        self.table = RangeTable(plan, self.space, cone)
        self.model: npt.NDArray[np.float32] = beam_model(cone.reach, self.table.bin)

    def build(self) -> Iterator[float]:
        """Compute it bit by bit; tells the share that is done after each."""
        if not self.is_built:
            yield from self.table.build()
            self.is_built = True


def _cone(config: LocalizationConfig, robot: RobotConfig) -> Cone:
    """What is expected of every sensor: there is one table for all. Raises MapError where that cannot be."""
    cones = {
        Cone(config.reach or each.reach, config.half_cone or each.half_cone, config.incidence or each.incidence)
        for each in (robot.of(Ultrasonic).values() or [HC_SR04])
    }
    if len(cones) > 1:
        raise MapError(
            "the ultrasonic sensors of [robot.sensors] differ, and localization takes all to be alike: set reach, "
            "half_cone and incidence of [localization] to what is true of most"
        )
    return cones.pop()
