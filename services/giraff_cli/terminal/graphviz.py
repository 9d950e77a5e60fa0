"""Text for Graphviz."""

from __future__ import annotations


def quoted(text: str) -> str:
    """As Graphviz takes a name."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
