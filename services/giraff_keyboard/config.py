"""The table `[keyboard]` of the robot file."""

from typing import Annotated, ClassVar

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning
from giraff_schemas.topics import require_chunk


class KeyboardConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How fast a key drives."""

    LIVE: ClassVar = Tuning.READ_ONLY

    operator: str = "keyboard"
    """Name under which this operator's commands are published: `cmd_vel/<operator>`."""
    steps: Annotated[int, Bounds(1, 100)] = 5
    """Speeds that + and - choose from, equally far apart; the last one is the robot's full speed."""
    first_step: int = 2
    """The one to begin with, from 1."""

    def __post_init__(self) -> None:
        require_chunk(self.operator)
        check_bounds(self)
        if not 1 <= self.first_step <= self.steps:
            raise ValueError(f"first_step is {self.first_step} and steps {self.steps}: it must be in 1..steps")
