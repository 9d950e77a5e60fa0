"""giraff_places: the process."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec

from giraff_maps.floor_plan import MapError, at_home, require_area
from giraff_maps.places_file import PlacesStore
from giraff_node import Node
from giraff_node.config.robot_file import ConfigError, load
from giraff_node.process.libraries import missing_library
from giraff_node.process.state import write_file_durably
from giraff_places.config import PlacesConfig
from giraff_schemas.services import LOCALIZATION, PLACES
from giraff_schemas.trouble import Trouble

if TYPE_CHECKING:
    from giraff_places.policy import PlanFile

_REFUSED: Final = 2
_NO_MAP: Final = Trouble(
    "no map is given", "set `map` of [localization] in the robot file, or GIRAFF_LOCALIZATION_MAP, to a floor plan"
)


class PlanTable(msgspec.Struct, frozen=True):
    """Field of the table [localization] that says which floor plan the robot is looked for on."""

    map: str = ""


def main() -> None:
    if why := missing_library(PLACES):
        print(f"giraff_places: {why}", file=sys.stderr)
        sys.exit(_REFUSED)
    from giraff_places.service import Places  # noqa: PLC0415  its library may be missing

    with Node("places", PlacesConfig) as node:
        source = plan_of_localization()
        store = None if isinstance(source, Trouble) else PlacesStore(Path(source.path), write_file_durably)
        node.run(Places(node, node.config, node.robot, source, store))


def plan_of_localization() -> "PlanFile | Trouble":
    """Return the floor plan that the robot file names, or why there is none."""
    from giraff_maps.read import read_map  # noqa: PLC0415  its library may be missing
    from giraff_places.policy import PlanFile  # noqa: PLC0415  as above

    try:
        if not (name := load(LOCALIZATION.table, PlanTable).map):
            return _NO_MAP
        path = at_home(Path(name))
        plan = read_map(path)
        require_area(plan)
        return PlanFile(plan, str(path))
    except (ConfigError, MapError) as error:
        return Trouble(str(error))
