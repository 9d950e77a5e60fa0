"""Ten minutes of `giraff run`: rates, gaps, memory."""

import json
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from giraff_schemas.topics import TOPICS
from giraff_sim.board import ROOT
from tests.support.report import report

SECONDS = 600
SETTLED = 120.0  # s; memory may grow until then
GROWTH_LIMIT = 1 << 20  # bytes a process
BOARD_PACED = ("tilt", "range/front_left", "range/front_right", "range/rear", "wheels", "odom")
"""Keys whose rate a board sets."""


def resident(process: psutil.Process) -> dict[str, int]:
    """Resident bytes of a run's processes, by module."""
    sizes = {}
    for child in process.children(recursive=True):
        command = child.cmdline()
        if "-m" in command:
            module, *words = command[command.index("-m") + 1 :]
            sizes[words[0] if module == "giraff_node" else module] = child.memory_info().rss
    return sizes


@pytest.mark.timeout(SECONDS + 120)
def test_ten_minutes(tmp_path: Path) -> None:
    summary = tmp_path / "summary.json"
    command = [sys.executable, "-m", "giraff_cli", "run", "--for", str(SECONDS), "--local", "--summary", str(summary)]
    began = time.monotonic()
    settled: dict[str, int] = {}
    last: dict[str, int] = {}
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL) as run:
        process = psutil.Process(run.pid)
        while run.poll() is None and time.monotonic() - began < SECONDS - 10:
            time.sleep(5.0)
            last = resident(process)
            if not settled and time.monotonic() - began > SETTLED:
                settled = last
        assert run.wait(timeout=60) == 0
    figures = json.loads(summary.read_text())
    growth = {module: last[module] - settled[module] for module in settled}
    report("timing/ten-minutes", {**figures, "memory_growth_bytes": growth, "resident_bytes": last})
    assert figures["frames_lost"] == 0
    assert figures["contacts"] == 0
    # A board's rate is its own time's: the run's skew is taken out.
    nominal = {topic.key: topic.rate_hz for topic in TOPICS}
    for key in BOARD_PACED:
        expected = nominal.get(key, nominal.get("range/*", 0.0))
        assert figures["rates_hz"][key] == pytest.approx(expected, rel=0.02), key
    assert set(growth) >= {"base", "guard", "joystick", "ranger", "odometry"}
    for module, grown in growth.items():
        assert grown < GROWTH_LIMIT, f"{module} grew by {grown} bytes"
