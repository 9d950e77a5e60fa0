"""A clone of the repository with its `.env`, as a technician makes one on each host."""

import re
import shutil
from collections.abc import Mapping
from pathlib import Path

from tests.rules.repository import ROOT, files

NOT_CLONED = ("tests", "docs", ".ci")


def clone(place: Path) -> None:
    """What is, or would be, in the repository; without what no host needs."""
    for path in files():
        name = path.relative_to(ROOT)
        if name.parts[0] in NOT_CLONED:
            continue
        target = place / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, target)


def write_env(place: Path, kind: str, changes: Mapping[str, str], more: Mapping[str, str] | None = None) -> None:
    """`.env` made of that kind's example: the lines that a technician edits, and more that the example has not."""
    text = (place / "deploy" / "env" / f"{kind}.env").read_text()
    for name, value in changes.items():
        text, count = re.subn(rf"^#?{name}=.*$", f"{name}={value}", text, flags=re.MULTILINE)
        assert count == 1, f"deploy/env/{kind}.env: {count} lines for {name} where one is to be edited"
    text += "".join(f"{name}={value}\n" for name, value in (more or {}).items())
    (place / ".env").write_text(text)
