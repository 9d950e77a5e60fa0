"""The name of a place whose hosts reach each other directly, and others through a router."""

from __future__ import annotations

from typing import Final

_LONGEST: Final = 32  # bytes that Zenoh has for the name of a region


def require_site(name: str) -> None:
    """ValueError unless it can be the name of a site."""
    if not name or not name.isprintable() or len(name.encode()) > _LONGEST:
        raise ValueError(f"site {name!r}: give a name of 1 to {_LONGEST} letters, like home")
