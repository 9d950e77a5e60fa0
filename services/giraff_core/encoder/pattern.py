"""The edges of an encoder in one turn of its disk, as a drawing, a simulator or a count of them has them."""

from __future__ import annotations

from typing import NamedTuple


class Edge(NamedTuple):
    """A change of one channel or both."""

    at: float
    """Share of a turn, 0 up to but not including 1, in the forward direction."""
    a: bool
    """Level of channel A just after the edge, while the disk turns forward."""
    b: bool
    """Level of channel B just after the edge, while the disk turns forward."""


class Pattern(NamedTuple):
    """All edges of one turn."""

    states_per_turn: int
    """States by which the position grows in a turn: four for each black and white pair of the ideal disk."""
    edges: tuple[Edge, ...]
    """In the order of their positions."""
