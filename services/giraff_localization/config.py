"""The table `[localization]` of the robot file."""

import math
from typing import Annotated

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning


class LocalizationConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The map, and what the filter may take."""

    map: Annotated[str, Tuning.READ_ONLY] = ""
    """Path of the floor plan on this host: a room (`.toml`) or a grid of ROS's map_server (`.yaml`); empty: none."""
    least_particles: Annotated[int, Tuning.READ_ONLY, Bounds(100, 100_000)] = 1000
    """While it is known where the robot is."""
    most_particles: Annotated[int, Tuning.READ_ONLY, Bounds(100, 1_000_000)] = 40_000
    """While it is looked for anywhere."""
    reach: Annotated[float | None, Tuning.READ_ONLY, Bounds(0.5, 10.0, "m")] = None
    """m; of all sensors, in place of what each has. None: as `[robot.sensors.<name>]` has it."""
    half_cone: Annotated[float | None, Tuning.READ_ONLY, Bounds(math.radians(1.0), math.radians(45.0), "rad")] = None
    """rad; as of `reach`."""
    incidence: Annotated[float | None, Tuning.READ_ONLY, Bounds(math.radians(5.0), math.radians(85.0), "rad")] = None
    """rad; as of `reach`."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.least_particles > self.most_particles:
            raise ValueError(
                f"least_particles is {self.least_particles} and most_particles {self.most_particles}: "
                "the least must not be more"
            )
