"""How much the viewer may keep: then the oldest is forgotten."""

from __future__ import annotations

import re
from typing import Final

DEFAULT: Final = "1GB"
LATECOMERS: Final = "1MB"
"""What a window's own server keeps for viewers that join later: there are none, and the limit of all counts it too."""

GIVE_BACK: Final = {"MIMALLOC_PURGE_DELAY": "0"}
"""The viewer's environment: what it has forgotten goes back to the machine at once. Else each peak stays for good."""

_LEAST: Final = 50e6  # bytes; below it hardly a minute is kept
_SIZE: Final = re.compile(r"(\d+(?:\.\d+)?) ?(k|M|G|T|Ki|Mi|Gi|Ti)?B")
_SHARE: Final = re.compile(r"(\d+)%")
_UNITS: Final = {
    "": 1.0,
    "k": 1e3,
    "M": 1e6,
    "G": 1e9,
    "T": 1e12,
    "Ki": 2.0**10,
    "Mi": 2.0**20,
    "Gi": 2.0**30,
    "Ti": 2.0**40,
}


def require_memory(text: str) -> str:
    """A limit as rerun takes it. Raises ValueError."""
    if share := _SHARE.fullmatch(text):
        if 1 <= int(share[1]) <= 90:
            return text
        raise ValueError(f"{text} of this machine's memory: give 1% to 90%")
    size = _SIZE.fullmatch(text)
    if size is None:
        raise ValueError(f"{text!r} is no amount of memory; give one like 500MB, 2GiB or 25%")
    if float(size[1]) * _UNITS[size[2] or ""] < _LEAST:
        raise ValueError(f"{text} holds hardly a minute of a robot; give 50MB at the least")
    return text.replace(" ", "")
