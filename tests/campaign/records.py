"""Dated results of the long runs, each bound to the files that it judges and to no others.

Usage: python -m tests.campaign.records: names the newest records that are older than their files.
"""

from __future__ import annotations

import datetime as dt
import hashlib
import json
import platform
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from giraff_sim.board import ROOT

RECORDS: Final = ROOT / "docs" / "campaign"
ROBOT_FILE: Final = "deploy/robot.toml"
FIRMWARE: Final = ("firmware", ROBOT_FILE)
"""What the boards' C compiled for this machine is, and what it is told."""
PROCESSES: Final = tuple(f"giraff_{name}.main" for name in ("base", "guard", "joystick", "ranger", "odometry", "sim"))
"""Modules of a robot of real processes,"""
ROBOT: Final = (*FIRMWARE, "services/giraff_sim/lockstep", "services/giraff_node/zenoh")
"""and what these read: the firmware on simavr, and what Zenoh is told."""
_SHOWN: Final = 3  # files of an old record
_BOOKKEEPING: Final = ("tests/campaign/records.py", "tests/timing/stalled.py", "tests/timing/sleepers.py")
"""Imported by the campaigns, and without a part in what they find."""
_FILES_OF: Final = """
import importlib, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
print(*(file for module in sys.modules.values() if (file := getattr(module, "__file__", None))), sep="\\n")
"""


def judged(*modules: str, also: tuple[str, ...] = ()) -> dict[str, str]:
    """The tracked files that these modules run, and those of `also` (a folder: all in it), each with its digest."""
    listed = _lines([sys.executable, "-c", _FILES_OF, *modules])
    imported = {str(Path(line).relative_to(ROOT)) for line in listed if Path(line).is_relative_to(ROOT)}
    tracked = {name for name in _lines(["git", "ls-files"]) if not name.endswith(".md")}
    named = {name for name in tracked for part in also if name == part or name.startswith(f"{part}/")}
    files = (imported & tracked | named) - {*_BOOKKEEPING}
    return {name: digest(ROOT / name) for name in sorted(files) if not (ROOT / name).is_symlink()}


def digest(file: Path) -> str:
    """The begin of its SHA-256; '' of a file that is no more."""
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16] if file.is_file() else ""


def write_record(name: str, figures: Mapping[str, Any], files: Mapping[str, str]) -> Path:
    """Write docs/campaign/DATE-NAME.json; `files`: what the figures are of, from `judged`."""
    today = dt.datetime.now(dt.UTC).date().isoformat()
    record = {
        "date": today,
        "machine": platform.machine(),
        "python": platform.python_version(),
        **figures,
        "files": files,
    }
    RECORDS.mkdir(parents=True, exist_ok=True)
    path = RECORDS / f"{today}-{name}.json"
    path.write_text(json.dumps(record, indent=2) + "\n")
    return path


def older(records: Path = RECORDS, root: Path = ROOT) -> dict[str, str]:
    """Of the newest record of each campaign, those that are older than their files, and which files these are."""
    newest = {path.name[len("2026-01-01-") :]: path for path in sorted(records.glob("*.json"))}
    found = {}
    for path in newest.values():
        files: dict[str, str] | None = json.loads(path.read_text()).get("files")
        if files is None:
            found[path.name] = "does not say which files it judged"
        elif changed := [name for name, was in files.items() if digest(root / name) != was]:
            more = f" and {len(changed) - _SHOWN} more" if len(changed) > _SHOWN else ""
            found[path.name] = f"is older than {', '.join(changed[:_SHOWN])}{more}"
    return found


def _lines(command: list[str]) -> list[str]:
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()


if __name__ == "__main__":
    for name, why in older().items():
        print(f"  record     {name} {why}")
