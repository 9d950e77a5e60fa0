"""The figures of a long run: a small table on the terminal, JSON in build/."""

import datetime as dt
import json
import platform
from collections.abc import Mapping
from typing import Any, Final

from giraff_sim.board import BUILD

_WIDEST: Final = 90
"""Characters of a figure that are shown; the file has all."""


def report(name: str, figures: Mapping[str, Any]) -> None:
    """Print `figures` and write them to build/NAME.json, whatever is there; `name`: as campaign/rooms."""
    path = BUILD / f"{name}.json"
    about = {"date": dt.datetime.now(dt.UTC).date(), "machine": platform.machine(), "python": platform.python_version()}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(about | dict(figures), indent=2, default=str) + "\n")
    print(f"\n{path}")
    for figure, value in figures.items():
        told = value if isinstance(value, str) else json.dumps(value, default=str)
        print(f"  {figure:<32} {told if len(told) <= _WIDEST else told[: _WIDEST - 1] + '…'}")
