"""Doors of some widths, driven through by a motion: how wide one must be for each sense."""

import statistics
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Final

import pytest

from giraff_core.robot import PASSAGE
from tests.loop.doors import KINDS, pass_door
from tests.support.report import report

DRIVES: Final = {0.10: 10, 0.12: 10, PASSAGE: 40, 0.17: 10}
"""By m beyond the footprint at each side."""


@pytest.mark.parametrize("name", KINDS)
def test_a_door_of_the_promised_width_is_passed(name: str) -> None:
    figures, shares = {}, {}
    for beyond, drives in DRIVES.items():
        with ProcessPoolExecutor() as pool:
            made = list(pool.map(partial(pass_door, name, beyond), range(drives)))
        shares[beyond] = sum(drive.is_clean for drive in made) / drives
        figures[f"{beyond:.2f}_m"] = {
            "drives": drives,
            "clean": round(shares[beyond], 3),
            "touches_m_s": [round(speed, 2) for drive in made for speed in drive.touches],
            "median_s": round(statistics.median(drive.seconds for drive in made), 1),
            "most_blocked_s": round(max(drive.blocked for drive in made), 1),
        }
    report(f"campaign/doors_{name}", figures)
    assert shares[PASSAGE] >= 0.9
