"""make bench: measure, print, and renew results.json and docs/performance.md. ARGS="--rounds 1 --only pairs"."""

import argparse
import datetime as dt
import json
import os
import platform
import re
import subprocess
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

from bench import alone, pairs, robot
from bench.figures import Figures, as_json, from_json
from bench.pictures import pictures
from bench.report import page, tables
from giraff_sim.board import BUILD, ROOT

_PARTS: Final = {
    "pairs": pairs.measure,
    "robot": robot.measure,
    "codec": alone.measure_codec,
    "serial": alone.measure_serial,
    "simulation": alone.measure_simulation,
}
_ROUNDS: Final = 5
RESULTS: Final = ROOT / "bench" / "results.json"
PAGE: Final = ROOT / "docs" / "performance.md"
PICTURES: Final = ROOT / "docs" / "pictures"


def main() -> None:
    parser = argparse.ArgumentParser(prog="make bench", description="Measure services beside bare Zenoh.")
    parser.add_argument("--rounds", type=_rounds, default=_ROUNDS, help="how often everything is measured")
    parser.add_argument("--only", action="append", choices=_PARTS, help="one part; may be given several times")
    given = parser.parse_args()
    about, figures = _about(), Figures()
    for number in range(given.rounds):
        for part in given.only or _PARTS:
            print(f"round {number + 1} of {given.rounds}: {part}", flush=True)
            _PARTS[part](figures)
    results = {**about, "rounds": given.rounds, "figures": as_json(figures)}
    print(tables(results))
    is_whole = given.only is None and given.rounds >= _ROUNDS
    path = RESULTS if is_whole else BUILD / "bench" / "results.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(_text(results), encoding="utf-8")
    print(f"\n{path.relative_to(ROOT)}")
    if is_whole:
        PAGE.write_text(page(PAGE.read_text(encoding="utf-8"), results), encoding="utf-8")
        for name, drawn in pictures(from_json(results["figures"])).items():
            (PICTURES / name).write_text(drawn, encoding="utf-8")


def _rounds(text: str) -> int:
    if not text.isdecimal() or not int(text):
        raise argparse.ArgumentTypeError(f"{text!r} is no number of rounds; give a whole number of at least 1")
    return int(text)


def _text(results: dict[str, Any]) -> str:
    """Return JSON with the values of a figure on one line."""
    return re.sub(r"\[[^][{}]*\]", lambda values: re.sub(r"\s+", " ", values[0]), json.dumps(results, indent=1)) + "\n"


def _about() -> dict[str, Any]:
    model = [line for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines() if "model name" in line]
    processor = model[0].partition(":")[2].strip() if model else platform.machine()
    return {
        "date": str(dt.datetime.now(dt.UTC).date()),
        "commit": _commit(),
        "machine": {
            "processor": processor,
            "cores": f"{os.cpu_count()} cores",
            "kernel": "Linux " + ".".join(platform.release().split(".")[:2]),
        },
        "versions": {
            "Python": platform.python_version(),
            **{name: version(name) for name in ("giraff", "eclipse-zenoh", "msgspec")},
        },
    }


def _commit() -> str:
    """Return the short name of the commit that is measured, with `+` where files differ from it."""
    words = ["git", "describe", "--always", "--dirty=+", "--exclude=*"]
    try:
        return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


if __name__ == "__main__":
    main()
