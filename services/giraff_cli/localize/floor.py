"""A floor plan as localization needs it, with the file's name where it cannot be one."""

from pathlib import Path

from giraff_core.robot import RobotConfig
from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_maps.floor_plan import FloorPlan, MapError


def floor_of(path: Path, plan: FloorPlan, config: LocalizationConfig, robot: RobotConfig) -> Floor:
    """Raises MapError where no robot of this size drives on it."""
    try:
        return Floor(plan, config, robot)
    except MapError as error:
        raise MapError(f"{path}: {error}") from error
