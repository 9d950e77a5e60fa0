"""A floor plan as a search needs it: places where a robot can be, and what its sensors would tell there."""

from collections.abc import Iterator
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_localization.beams.ultrasonic import Sonars
from giraff_localization.config import LocalizationConfig
from giraff_localization.free_space import FreeSpace
from giraff_maps.floor_plan import FloorPlan, MapError, require_area
from giraff_maps.scan.plan_walls import PlanWalls

_BODY: Final = 0.7
"""Of the footprint's radius: a map is not exact, and a robot that touches furniture is somewhere all the same."""
_SMALLEST: Final = 0.5
"""m² where the robot's middle can be."""


class Floor:
    """Raises MapError for a plan that no robot of this size drives on. Of no use until it is built."""

    def __init__(self, plan: FloorPlan, config: LocalizationConfig, robot: RobotConfig) -> None:
        footprint_radius = robot.footprint_radius
        self.plan = plan
        self.is_built = False
        require_area(plan)
        bounds = plan.bounds
        width, depth = bounds.right - bounds.left, bounds.top - bounds.bottom
        self.space = FreeSpace(plan, _BODY * footprint_radius)
        if self.space.area < _SMALLEST:
            raise MapError(
                f"the map {plan.name!r}, {width:.2f} m by {depth:.2f} m, has no room for a robot of "
                f"{2.0 * footprint_radius:.2f} m across: is it in metres?"
            )
        self.walls = PlanWalls(plan) if robot.of(LaserScanner) else None
        """As a laser scanner sees them. None: the robot has no scanner, and is found by its sonars."""
        self.sonars = Sonars(plan, self.space, config, robot)

    def build(self) -> Iterator[float]:
        """Compute it bit by bit; tells the share that is done after each."""
        if not self.is_built:
            yield from (self.walls or self.sonars).build()
            self.is_built = True
