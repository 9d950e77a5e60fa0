"""The table `[sentry]` of the robot file. Who may do what is in `[network.access]`."""

from typing import Annotated

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning


class SentryConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How often the same refusal is told."""

    again: Annotated[float, Tuning.FREE, Bounds(0.01, 86_400.0, "s")] = 10.0
    """s until a refusal that goes on is told again, with its count."""

    def __post_init__(self) -> None:
        check_bounds(self)
