"""Says which library is missing, before a module is imported that needs it."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Final

_LIBRARIES: Final = {"cv2": "opencv-python-headless", "numpy": "numpy"}


def missing_library() -> str:
    """Say what to install before the camera or vision can be used; empty: all is there."""
    missing = [name for module, name in _LIBRARIES.items() if find_spec(module) is None]
    return f"the library {missing[0]} is missing; in the clone: pip install '.[camera]'" if missing else ""
