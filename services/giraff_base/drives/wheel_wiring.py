"""How motors and encoders are soldered: fields of `[base.drive]` that each kind on two wheels has."""

from typing import ClassVar, Final

import msgspec

from giraff_core.robot import WIRING
from giraff_schemas.actions import Action
from giraff_schemas.wire import Wiring

CHECK_THEM: Final[tuple[str, Action, str]] = "lift the wheels", "run", "giraff check wheels"
"""Remedy, action and argument where the wiring may be wrong."""


class WheelWiring(msgspec.Struct, frozen=True, kw_only=True):
    """The six bits of the wiring. None: nobody has checked, and base does not arm."""

    BY_HAND: ClassVar[str] = ""
    """Page by which a robot of this kind is wired and tuned by hand. Empty: `giraff check` and `giraff tune` do it."""

    swap_motors: bool | None = None
    swap_encoders: bool | None = None
    invert_left_motor: bool | None = None
    invert_right_motor: bool | None = None
    invert_left_encoder: bool | None = None
    invert_right_encoder: bool | None = None

    @property
    def is_checked(self) -> bool:
        """Whether somebody has checked all of them."""
        return all(getattr(self, name) is not None for name in WIRING)

    @property
    def wiring(self) -> Wiring:
        """The bits that the board's `configure` frame carries. An unchecked one counts as not set."""
        return Wiring(sum(Wiring[name.upper()] for name in WIRING if getattr(self, name)))
