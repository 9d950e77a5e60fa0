"""Dated results of the long runs, bound to the sources they were made with."""

from __future__ import annotations

import datetime as dt
import hashlib
import json
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

from giraff_sim.board import ROOT

RECORDS = ROOT / "docs" / "campaign"
_SOURCES = ("schemas", "services", "firmware", "deploy", "requirements")
_FILES_OF = """
import sys, {module}
print(*(file for module in sys.modules.values() if (file := getattr(module, "__file__", None))), sep="\\n")
"""


def sources_of(module: str) -> tuple[str, ...]:
    """What a module runs: the firmware, the robot file, and of our own Python what it imports, from the root on."""
    listed = subprocess.run(
        [sys.executable, "-c", _FILES_OF.format(module=module)], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    ours = (Path(line) for line in listed.splitlines() if Path(line).is_relative_to(ROOT))
    imported = {str(path.relative_to(ROOT)) for path in ours}
    return (*sorted(path for path in imported if path.startswith(_SOURCES)), "firmware", "deploy/robot.toml")


def source_hash(sources: tuple[str, ...] = _SOURCES) -> str:
    """SHA-256 over what is run: every tracked file of these, by name and content."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--", *sources], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    digest = hashlib.sha256()
    for name in sorted(filter(None, listed.split("\0"))):
        if (ROOT / name).is_symlink():  # what it leads to is listed by its own name
            continue
        digest.update(name.encode() + b"\0" + (ROOT / name).read_bytes() + b"\0")
    return digest.hexdigest()


def write_record(name: str, figures: dict[str, Any], sources: tuple[str, ...] = _SOURCES) -> Path:
    """Write docs/campaign/DATE-NAME.json; `sources`: what the figures are of."""
    today = dt.datetime.now(dt.UTC).date().isoformat()
    record = {
        "date": today,
        "source_sha256": source_hash(sources),
        "machine": platform.machine(),
        "python": platform.python_version(),
        **figures,
    }
    RECORDS.mkdir(parents=True, exist_ok=True)
    path = RECORDS / f"{today}-{name}.json"
    path.write_text(json.dumps(record, indent=2) + "\n")
    return path
