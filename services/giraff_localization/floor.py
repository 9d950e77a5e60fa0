"""A floor plan as the filter needs it: where a robot can be, and what it would hear there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_core.robot import RobotConfig
from giraff_core.sensors import HC_SR04
from giraff_localization.beam_model import beam_model
from giraff_localization.config import LocalizationConfig
from giraff_localization.free_space import FreeSpace
from giraff_localization.range_table import Cone, RangeTable
from giraff_maps.floor_plan import FloorPlan, MapError

_BODY: Final = 0.7
"""Of the footprint's radius: a map is not exact, and a robot that touches furniture is somewhere all the same."""
_LARGEST: Final = 2000.0
"""m² of the rectangle about the plan: the table has 29 kB for each m²."""
_SMALLEST: Final = 0.5
"""m² where the robot's middle can be."""


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
        Cone(config.reach or model.reach, config.half_cone or model.half_cone, config.incidence or model.incidence)
        for model in ([robot.model(sensor) for sensor in robot.sensors] or [HC_SR04])
    }
    if len(cones) > 1:
        raise MapError(
            "the ultrasonic sensors of [robot.sensors] differ, and localization takes all to be alike: set reach, "
            "half_cone and incidence of [localization] to what is true of most"
        )
    return cones.pop()
