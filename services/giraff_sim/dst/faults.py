"""What a fault is: a function that begins it, yields what to tell, and ends it when it is called on.

One that finds what it would spoil spoilt already returns before it yields: it does not happen.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from random import Random
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from giraff_sim.dst.drill import Drill

Course = Generator[str, None, None]
Begin = Callable[["Drill", Random], Course]


class Kind(NamedTuple):
    """A kind of fault."""

    name: str
    begin: Begin
    weight: float
    """How often it is drawn, beside the others."""
    lasts: tuple[float, float]
    """s, from and to."""
    calm_after: float
    """s after its end until everything can be proven again."""


def fault(
    kinds: list[Kind], weight: float, lasts: tuple[float, float], calm_after: float = 3.0
) -> Callable[[Begin], Begin]:
    """Add a function to the `kinds` that are drawn from; its name is the fault's."""

    def add(begin: Begin) -> Begin:
        name = getattr(begin, "__name__", "").replace("_", " ")
        kinds.append(Kind(name, begin, weight, lasts, calm_after))
        return begin

    return add
