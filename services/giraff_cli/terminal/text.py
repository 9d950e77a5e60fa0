"""Text for a terminal."""

from __future__ import annotations


def printable(text: str) -> str:
    """Text of the network on one line: what it says may not steer the terminal."""
    return "".join(character if character.isprintable() else "?" for character in text)


def counted(number: int, thing: str) -> str:
    """How many there are of a thing."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def duration(seconds: float) -> str:
    """Like 2 h 05 min."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {rest:02} s" if minutes else f"{rest} s"
