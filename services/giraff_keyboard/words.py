"""What services say of a hand, for one who drives with keys."""

from __future__ import annotations

from typing import Final

from giraff_core.estop.latch import RESET_COMMAND

_OF_KEYS: Final = {
    "hold the hand level": "let go of all keys",
    "tilt or press a key to ask, then hold level with no key pressed to arm": (
        "press an arrow key or c to ask, then let go of all keys to arm"
    ),
    "tilt or press a drive key to take it, then hold level with no key pressed to arm": (
        "press an arrow key to take it, then let go of all keys to arm"
    ),
    "no operator is heard; start giraff drive or giraff_joystick": (
        "nobody drives; press an arrow key or c to ask, then let go of all keys to arm"
    ),
    RESET_COMMAND: "press r",
}
"""By what base and guard say; the longer one before one that is in it."""


def for_keys(reason: str) -> str:
    """The same reason with the way out of a keyboard."""
    for said, of_keys in _OF_KEYS.items():
        reason = reason.replace(said, of_keys)
    return reason
