"""The latch of the emergency stop: what base holds in memory and keeps on disk. No I/O here.

A file that is missing, damaged or cannot be read says nothing, and then the robot stays stopped.
"""

from typing import Annotated, Final

import msgspec

from giraff_core.io import Store, Writer
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.text import plain
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LATCH_FILE: Final = "estop.json"
SEE_THAT_IT_MAY: Final = "see that the robot may move"
"""Remedy before a release, where the cause names none."""


class EStopLatch(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Engaged or released, and who did that."""

    engaged: bool
    id: Annotated[int, msgspec.Meta(ge=0, lt=1 << 53)]
    """Names the newest engaging; a reset that names another clears nothing."""
    by: str
    reason: Trouble
    """Cause of the stop, and the way to release it."""
    off: bool = False
    """The stop has switched off a drive that else holds the robot up."""
    empty: bool = False
    """The battery was empty, whoever engaged the stop: base refuses a reset until it is charged."""


def is_confirmed_stop(answer: EStopAnswer) -> bool:
    """Whether base has stopped and will stay so, after a restart, too."""
    return answer.done and answer.engaged


RELEASED: Final = EStopLatch(engaged=False, id=0, by="", reason=NO_TROUBLE)


def latch_bytes(latch: EStopLatch) -> bytes:
    """As it is kept."""
    return msgspec.json.encode(latch) + b"\n"


def load_latch(store: Store, lost_id: int) -> EStopLatch:
    """The latch that was kept; where none can be read an engaged one, `lost_id`."""
    path = store.path(LATCH_FILE)
    try:
        return msgspec.json.decode(store.read(LATCH_FILE), type=EStopLatch)
    except FileNotFoundError:
        why = f"{path} is missing, as at a first start"
    except OSError as error:
        why = f"{path} cannot be read: {error.strerror}"
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        why = f"{path} is damaged: {plain(error)}"
    return EStopLatch(
        engaged=True,
        id=lost_id,  # of the one that was lost nothing is known: not its id again
        by="base",
        reason=Trouble(why, SEE_THAT_IT_MAY, "release"),
    )


class LatchSaver:
    """Writes latches where a disk that hangs for seconds does not hold up drive frames."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._latch = RELEASED

    def save(self, latch: EStopLatch) -> None:
        """Begin to write; `outcome` tells how it went. One at a time."""
        self._latch = latch
        self._writer.save(latch_bytes(latch))

    def outcome(self) -> tuple[EStopLatch, str] | None:
        """What was written and why it failed, empty when it is on disk; None: no news."""
        why = self._writer.outcome()
        return None if why is None else (self._latch, why)
