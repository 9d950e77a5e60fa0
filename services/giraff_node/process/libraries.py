"""Says which library is missing, before a module is imported that needs it, and what brings it."""

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from giraff_schemas.services import Service

_DISTRIBUTIONS: Final = {"cv2": "opencv-python-headless"}
TREE: Final = Path(__file__).resolve().parents[3]
"""The repository, where the code runs from one."""
_TARGETS: Final = ("viewer", "camera")
"""Extras that the clone's Makefile adds by their names. `make setup` adds all."""


def remedy(extras: str, tree: Path = TREE, prefix: Path = Path(sys.prefix)) -> str:
    """Return what to type for these extras of the distribution, like "camera,cli".

    `tree` is the clone, where the code runs from one. `prefix` is the virtual environment.
    """
    if (prefix / "made-of").is_file():
        return "docs/install.md says which LOCK of make install has it"
    if not (tree / "pyproject.toml").is_file():
        return f"pip install 'giraff[{extras}] @ file:///FOLDER/giraff-VERSION-py3-none-any.whl'"
    if prefix != tree / ".venv":
        return f"in the clone: pip install '.[{extras}]'"
    return f"in the clone: make {next((each for each in _TARGETS if each in extras.split(',')), 'setup')}"


def missing_library(service: Service) -> str:
    """Say what to install before the service can be used; empty: all is there."""
    missing = next((module for module in service.libraries if find_spec(module) is None), "")
    return f"the library {_DISTRIBUTIONS.get(missing, missing)} is missing; {remedy(service.extra)}" if missing else ""
