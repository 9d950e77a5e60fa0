"""The latch of the emergency stop: what base holds in memory and keeps on disk."""

from __future__ import annotations

from typing import Annotated, Final

import msgspec

from giraff_schemas.messages import EStopAnswer

RESET_COMMAND: Final = "giraff estop reset"


class EStopLatch(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Engaged or released, and who did that."""

    engaged: bool
    id: Annotated[int, msgspec.Meta(ge=0, lt=1 << 53)]
    """Names the newest engaging; a reset that names another clears nothing."""
    by: str
    reason: str
    """Why it is engaged, with the way out; empty when it is not."""


def stops_for_good(answer: EStopAnswer) -> bool:
    """Whether base has stopped and will stay so, after a restart, too."""
    return answer.done and answer.engaged


RELEASED: Final = EStopLatch(engaged=False, id=0, by="", reason="")
