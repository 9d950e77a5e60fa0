"""Text that others have written, made fit for a terminal and for a log. The only place that does so."""

from __future__ import annotations


def printable(text: str) -> str:
    """Return the text on one line, with "?" for each character that could steer a terminal or hide other text."""
    return "".join(character if character.isprintable() else "?" for character in text)


def printable_lines(text: str) -> str:
    """Clean each line like `printable`, and keep the ends of the lines."""
    return "\n".join(map(printable, text.split("\n")))
