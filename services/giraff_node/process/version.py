"""Which program this is, so that hosts can be compared."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Final

import giraff_core
import giraff_schemas

_SHARED: Final = (
    Path(giraff_schemas.__file__).parent,
    Path(giraff_core.__file__).parent,
    Path(__file__).parents[1],
)
"""The folders of schemas, core and runtime: what all processes of a robot run on."""


@cache
def version() -> str:
    """Number of the distribution, and a digest of what all services share: the number alone stays between releases."""
    try:
        number = distribution("giraff").version
    except PackageNotFoundError:
        number = "unknown"
    digest = hashlib.sha256()
    for folder in _SHARED:
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{number}-{digest.hexdigest()[:8]}"
