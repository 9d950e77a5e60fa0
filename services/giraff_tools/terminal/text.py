"""Text for a terminal."""

import re
from typing import Any, Final

import msgspec

_STEERING: Final = re.compile(r"[^\n -~]")


def counted(number: int, thing: str) -> str:
    """How many there are of a thing."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def duration(seconds: float) -> str:
    """Like 2 h 05 min."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {rest:02} s" if minutes else f"{rest} s"


def json_line(document: Any) -> str:
    """Write the document as JSON. What could steer a terminal is escaped, and stays in the text."""
    return _STEERING.sub(_escaped, msgspec.json.encode(document).decode())


def json_page(document: Any) -> str:
    """Write the document as `json_line` does, in indented lines."""
    return _STEERING.sub(_escaped, msgspec.json.format(msgspec.json.encode(document), indent=2).decode())


def quoted(text: str) -> str:
    """Write the text as Graphviz takes a name."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _escaped(found: re.Match[str]) -> str:
    character = found.group()
    if character.isprintable():
        return character
    units = character.encode("utf-16-be").hex()
    return "".join(f"\\u{units[start : start + 4]}" for start in range(0, len(units), 4))
