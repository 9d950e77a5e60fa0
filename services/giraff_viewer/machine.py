"""What the viewer takes of this machine: a Vulkan driver for a picture, and memory, until the oldest is forgotten.

A window can do without a Vulkan driver.
"""

import ctypes
import os
import re
import sys
from pathlib import Path
from typing import Final

DEFAULT: Final = "1GB"
"""Memory that the viewer may keep, as rerun takes it."""
LATECOMERS: Final = "1MB"
"""What a window's own server keeps for viewers that join later: there are none, and the limit of all counts it too."""
GIVE_BACK: Final = {"MIMALLOC_PURGE_DELAY": "0"}
"""The viewer's environment: what it has forgotten goes back to the machine at once. Else each peak stays for good."""
NO_VULKAN: Final = (
    "no Vulkan driver is found here, and --picture draws with one; install one: apt install mesa-vulkan-drivers "
    "(no graphics card is needed)"
)

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
_FOLDERS: Final = ("/etc", "/usr/local/share", "/usr/share", "/run/opengl-driver/share")


def has_vulkan() -> bool:
    """Return whether Vulkan's loader is here and would find a driver, by the files in which drivers name themselves.

    Other systems than Linux draw by other means.
    """
    return sys.platform != "linux" or (any(map(_is_driver, _places())) and _has_loader())


def _has_loader() -> bool:
    try:
        ctypes.CDLL("libvulkan.so.1")
    except OSError:
        return False
    return True


def _places() -> list[Path]:
    """Files and folders where the loader looks."""
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        if told := os.environ.get(name):
            return [Path(each) for each in told.split(":")]
    added = os.environ.get("VK_ADD_DRIVER_FILES", "").split(":")
    homes = [os.environ.get("XDG_DATA_HOME") or "~/.local/share", os.environ.get("XDG_CONFIG_HOME") or "~/.config"]
    folders = [*homes, *os.environ.get("XDG_DATA_DIRS", "").split(":"), *_FOLDERS]
    found = [Path(each).expanduser() / "vulkan" / "icd.d" for each in folders if each]
    return [*map(Path, filter(None, added)), *found]


def _is_driver(place: Path) -> bool:
    return place.is_file() or any(place.glob("*.json"))


def require_memory(text: str) -> str:
    """Return a limit of memory as rerun takes it. Raises ValueError."""
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
