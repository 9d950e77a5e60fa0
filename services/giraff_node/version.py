"""Which program this is, so that hosts can be compared."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import giraff_schemas

_SHARED = (Path(giraff_schemas.__file__).parent, Path(__file__).parent)


@cache
def version() -> str:
    """Number of the distribution, and a digest of schemas and runtime: the number alone does not change in between."""
    try:
        number = distribution("giraff").version
    except PackageNotFoundError:
        number = "unknown"
    digest = hashlib.sha256()
    for folder in _SHARED:
        for path in sorted(folder.glob("*.py")):
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{number}-{digest.hexdigest()[:8]}"
