"""What a process has used so far, by the kernel's own counts."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

_MIB = 1024.0  # KiB


class Usage(NamedTuple):
    """Counts since the process began, and what it has now."""

    worked: float
    """s of a processor, of all threads."""
    wakes: int
    """Voluntary context switches of all threads."""
    threads: int
    rss: float
    """MiB."""
    pss: float
    """MiB. Memory that several processes share counts in parts."""


def usage(pid: int) -> Usage:
    """Return what a living process has used. Of a thread that has ended, only its processor time counts on."""
    folder = Path(f"/proc/{pid}")
    fields = (folder / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    worked = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    tasks = [*(folder / "task").iterdir()]
    wakes = sum(int(_field(task / "status", "voluntary_ctxt_switches")) for task in tasks)
    rss, pss = (int(_field(folder / "smaps_rollup", name).split()[0]) / _MIB for name in ("Rss", "Pss"))
    return Usage(worked, wakes, len(tasks), rss, pss)


def _field(path: Path, name: str) -> str:
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(line.split(":", 1)[1].strip() for line in lines if line.startswith(f"{name}:"))


def quantiles_us(waits: Sequence[float]) -> dict[str, float]:
    """Return p50 and p90 of times in s, in us."""
    ordered = sorted(waits)
    return {f"p{p}": ordered[len(ordered) * p // 100] * 1e6 for p in (50, 90) if ordered}
