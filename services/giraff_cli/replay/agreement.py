"""How much of what was recorded is said again."""

import re
from collections.abc import Sequence
from typing import Final

import msgspec

from giraff_schemas.messages import RobotTime, Sample


class Agreement(msgspec.Struct, kw_only=True):
    """Of one service on one key."""

    service: str
    key: str
    compared: int = 0
    equal: int = 0
    first: str = ""
    """Of the first difference: where, recorded and replayed."""
    left_out: int = 0
    """Recorded samples that are not compared: the recording does not say what the policy remembered then."""

    @property
    def share(self) -> float:
        return self.equal / self.compared if self.compared else 0.0

    def add(self, recorded: Sample, found: Sequence[str]) -> None:
        """One more was compared. `found`: where it differs."""
        self.compared += 1
        if not found:
            self.equal += 1
        elif not self.first:
            self.first = f"seq {recorded.seq}: {'; '.join(found)}"


_AGE: Final = re.compile(r"\d+\.\d(?= s old)")
"""An age within a text, which is rounded at a moment that is known to a millisecond."""


def differences(then: msgspec.Struct, now: msgspec.Struct, tolerance: float) -> list[str]:
    """Where what was said then and what is said now are not the same; but for who said it when."""
    found = []
    for name in then.__struct_fields__:
        if name in {"seq", "stamp_ns", "instance", "heard", "decided_us"}:
            continue
        before, after = getattr(then, name), getattr(now, name)
        if isinstance(before, msgspec.Struct) and type(before) is type(after) and not isinstance(before, RobotTime):
            found += [f"{name}.{difference}" for difference in differences(before, after, tolerance)]
        elif isinstance(before, float) and isinstance(after, float):
            if abs(before - after) > tolerance:
                found.append(f"{name} {before:g} then, {after:g} now")
        elif _AGE.sub("", repr(before)) != _AGE.sub("", repr(after)):
            found.append(f"{name} {before!r} then, {after!r} now")
    return found
