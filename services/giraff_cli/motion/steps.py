"""Steps that can be meant."""

from __future__ import annotations

from giraff_schemas.motion import Arc, Move, Turn


def move(distance: float) -> Move:
    """Straight on. Raises ValueError for a way of no length."""
    if distance == 0.0:
        raise ValueError("a move of 0 m goes nowhere: give metres, negative for backward")
    return Move(distance=distance)


def turn(radians: float) -> Turn:
    """On the spot. Raises ValueError for no turn."""
    if radians == 0.0:
        raise ValueError("a turn of 0 turns nothing: write it like 90deg, negative for one to the right")
    return Turn(angle=radians)


def arc(radius: float, radians: float) -> Arc:
    """Along a circle. Raises ValueError for one that is none."""
    if radius <= 0.0:
        raise ValueError(f"a radius of {radius:g} m is none: give one above 0; a negative angle goes to the right")
    if radians == 0.0:
        raise ValueError("an arc of 0 goes nowhere: write its angle like 90deg, negative for one to the right")
    return Arc(radius=radius, angle=radians)
