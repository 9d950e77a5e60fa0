"""Text that the viewer can draw: its headless form ends at a character for which its font has no glyph."""

from __future__ import annotations

from typing import Final

_BLOCKS: Final = (range(0x20, 0x7F), range(0xA0, 0x149), range(0x14A, 0x17F), range(0x391, 0x3CA), range(0x410, 0x450))
ALPHABET: Final = tuple(chr(number) for block in _BLOCKS for number in block if chr(number).isprintable())
"""Latin with its accents, Greek and Cyrillic letters."""

_DRAWN: Final = frozenset(ALPHABET)


def drawable(text: str) -> str:
    """Text of the network on one line, with a question mark for each character that has no picture."""
    return "".join(character if character in _DRAWN else "?" for character in text)
