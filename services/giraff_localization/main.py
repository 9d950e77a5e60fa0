"""giraff_localization: the process."""

from pathlib import Path

from giraff_localization.config import LocalizationConfig
from giraff_localization.service import Localization
from giraff_maps.floor_plan import FloorPlan, MapError
from giraff_maps.read import read_map
from giraff_node import Node
from giraff_schemas.trouble import Trouble

_NO_MAP = Trouble(
    "no map is given", "set `map` of [localization] in the robot file, or GIRAFF_LOCALIZATION_MAP, to a floor plan"
)


def main() -> None:
    with Node("localization", LocalizationConfig) as node:
        node.run(Localization(node, node.config, node.robot, plan_of(node.config)))


def plan_of(config: LocalizationConfig) -> FloorPlan | Trouble:
    """The map that the robot file names; else why there is none."""
    if not config.map:
        return _NO_MAP
    try:
        return read_map(Path(config.map))
    except MapError as error:
        return Trouble(str(error))
