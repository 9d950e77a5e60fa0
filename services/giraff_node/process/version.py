"""Which program this is, so that hosts can be compared."""

import zlib
from functools import cache
from pathlib import Path
from typing import Final

import giraff_core
import giraff_schemas

NUMBER: Final = "0.1.0"
"""Of the distribution: pyproject.toml has it from here."""
_SHARED: Final = (
    Path(giraff_schemas.__file__).parent,
    Path(giraff_core.__file__).parent,
    Path(__file__).parents[1],
)
"""The folders of schemas, core and runtime: what all processes of a robot run on."""


@cache
def version() -> str:
    """Number of the distribution, and a digest of what all services share: the number alone stays between releases."""
    digest = 0  # a checksum: hashlib and importlib.metadata would take a tenth of the time in which a service starts
    for folder in _SHARED:
        for path in sorted(folder.rglob("*.py")):
            digest = zlib.crc32(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes(), digest)
    return f"{NUMBER}-{digest:08x}"
