"""Dated results of the long runs, bound to the sources they were made with."""

from __future__ import annotations

import datetime as dt
import hashlib
import json
import platform
import subprocess
from pathlib import Path
from typing import Any

from giraff_sim.board import ROOT

RECORDS = ROOT / "docs" / "campaign"
_SOURCES = ("schemas", "services", "firmware", "deploy", "requirements")


def source_hash() -> str:
    """SHA-256 over what is run: every tracked file of the sources, by name and content."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--", *_SOURCES], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    digest = hashlib.sha256()
    for name in sorted(filter(None, listed.split("\0"))):
        if (ROOT / name).is_symlink():  # what it leads to is listed by its own name
            continue
        digest.update(name.encode() + b"\0" + (ROOT / name).read_bytes() + b"\0")
    return digest.hexdigest()


def write_record(name: str, figures: dict[str, Any]) -> Path:
    """Write docs/campaign/DATE-NAME.json."""
    today = dt.datetime.now(dt.UTC).date().isoformat()
    record = {
        "date": today,
        "source_sha256": source_hash(),
        "machine": platform.machine(),
        "python": platform.python_version(),
        **figures,
    }
    RECORDS.mkdir(parents=True, exist_ok=True)
    path = RECORDS / f"{today}-{name}.json"
    path.write_text(json.dumps(record, indent=2) + "\n")
    return path
