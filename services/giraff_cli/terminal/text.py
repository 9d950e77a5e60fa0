"""Text for a terminal."""

from __future__ import annotations


def printable(text: str) -> str:
    """Text of the network on one line: what it says may not steer the terminal."""
    return "".join(character if character.isprintable() else "?" for character in text)


def counted(number: int, thing: str) -> str:
    """How many there are of a thing."""
    return f"{number} {thing}{'' if number == 1 else 's'}"
