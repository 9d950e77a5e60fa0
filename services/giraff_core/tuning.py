"""What may be done to a field of a configuration while its service runs. It stands beside the field."""

from enum import Enum
from typing import Any, get_type_hints

import msgspec


class Tuning(Enum):
    """`margin: Annotated[float, Tuning.RAISE_ONLY] = 0.25`.

    For a table of which all fields are alike: `LIVE: ClassVar = Tuning.READ_ONLY`.
    """

    RAISE_ONLY = "up"
    """It bears on safety, and a larger value is the tighter one: while the service runs it may only be raised."""
    LOWER_ONLY = "down"
    """It bears on safety, and a smaller value is the tighter one; None is tighter than any."""
    FREE = "free"
    """It bears on no safety: any valid value, at once."""
    CHECKED = "checked"
    """It bears on safety and has no looser side: any value that its table's own check takes, at once. Never saved."""
    READ_ONLY = "fixed"
    """It takes the robot file and a restart."""


def live_fields(config: type[msgspec.Struct]) -> dict[str, Tuning | None]:
    """By field, in order; None: nobody has said so, and it counts as fixed."""
    hints = get_type_hints(config, include_extras=True)
    of_all = getattr(config, "LIVE", None)
    return {
        name: next((said for said in getattr(hints[name], "__metadata__", ()) if isinstance(said, Tuning)), of_all)
        for name in config.__struct_fields__
    }


def loosens(live: Tuning, before: Any, after: Any) -> bool:
    """Whether a safety value that changes so protects less, or may do so."""
    if before is None or after is None:
        return after is not None
    return not (after >= before if live is Tuning.RAISE_ONLY else after <= before)
