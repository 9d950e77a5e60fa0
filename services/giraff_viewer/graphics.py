"""What a picture needs of this machine: a Vulkan driver. A window can do without."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path
from typing import Final

NO_VULKAN: Final = (
    "no Vulkan driver is found here, and --picture draws with one; install one: apt install mesa-vulkan-drivers "
    "(no graphics card is needed)"
)
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
