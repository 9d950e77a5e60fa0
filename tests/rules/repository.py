"""The repository as the rules see it: its files, its packages, its declared dependencies."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from tests.support.tools import finished

ROOT = Path(__file__).resolve().parents[2]
SOURCE_ROOTS = ("schemas", "services")
NOT_SERVICES = {
    "giraff_schemas",
    "giraff_health",
    "giraff_core",
    "giraff_node",
    "giraff_mcap",
    "giraff_viewer",
    "giraff_sim",
    "giraff_cli",
    "giraff_client",
}


@cache
def files() -> tuple[Path, ...]:
    """Every file that is, or would be, in the repository; ignored ones are nobody's business."""
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    output = finished(listing, cwd=ROOT, check=True).stdout
    paths = (ROOT / name for name in output.split("\0") if name)
    return tuple(sorted(path for path in paths if path.is_file()))


def sources(*suffixes: str, under: tuple[str, ...] = ()) -> list[Path]:
    """Files of these suffixes, in these top-level directories or anywhere."""
    return [
        path for path in files() if path.suffix in suffixes and (not under or path.relative_to(ROOT).parts[0] in under)
    ]


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def packages() -> list[str]:
    """Import packages of both source roots."""
    return sorted(init.parent.name for root in SOURCE_ROOTS for init in (ROOT / root).glob("giraff_*/__init__.py"))


def services() -> list[str]:
    return [package for package in packages() if package not in NOT_SERVICES]


def pyproject() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())
