"""The page's files, read once at the start: a request reaches no disk, and no path of anything else."""

from __future__ import annotations

from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import PurePosixPath
from typing import Final, NamedTuple

_TYPES: Final = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".json": "application/json",
    ".webmanifest": "application/manifest+json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".ico": "image/x-icon",
}


class File(NamedTuple):
    """As it is served."""

    data: bytes
    content_type: str


def page_files() -> dict[str, File]:
    """By path below `page`; those of other types are not served."""
    return dict(_found(files("giraff_web") / "page", ""))


def _found(folder: Traversable, below: str) -> list[tuple[str, File]]:
    if not folder.is_dir():
        return []
    found = []
    for entry in folder.iterdir():
        name = below + entry.name
        if entry.is_dir():
            found += _found(entry, f"{name}/")
        elif content_type := _TYPES.get(PurePosixPath(name).suffix):
            found.append((name, File(entry.read_bytes(), content_type)))
    return found
