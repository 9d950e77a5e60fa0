"""A robot that sees by a laser scanner alone: posts, furniture, and faults of the scanner."""

import statistics
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any, Final

import pytest

from tests.loop.scan_faults import BOUND, CREEP, FAULTS, Reaction, react
from tests.loop.scanning import Drive, drive_at_post, drive_wildly
from tests.support.report import report

POSTS: Final = 500
WILD: Final = 120
FAULT_SEEDS: Final = 20
_POST_S: Final = 5.5
_WILD_S: Final = 20.0


@pytest.fixture(scope="module")
def figures() -> Iterator[dict[str, Any]]:
    """The figures of all that was driven, reported at its end."""
    found: dict[str, Any] = {}
    yield found
    report("campaign/scan", found)


@pytest.mark.parametrize("first", range(0, POSTS, 100))
def test_no_post_is_touched(first: int, figures: dict[str, Any]) -> None:
    with ProcessPoolExecutor() as pool:
        drives = list(pool.map(partial(drive_at_post, seconds=_POST_S), range(first, first + 100)))
    figures[f"posts_from_{first}"] = _told(drives)
    assert [drive for drive in drives if drive.hard] == []


@pytest.mark.parametrize("first", range(0, WILD, 30))
def test_no_furniture_is_touched(first: int, figures: dict[str, Any]) -> None:
    with ProcessPoolExecutor() as pool:
        drives = list(pool.map(partial(drive_wildly, seconds=_WILD_S), range(first, first + 30)))
    figures[f"wild_from_{first}"] = _told(drives)
    assert [drive for drive in drives if drive.hard] == []


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_stops_it_or_slows_it(name: str, figures: dict[str, Any]) -> None:
    with ProcessPoolExecutor() as pool:
        reactions: list[Reaction] = list(pool.map(partial(react, name, after=1.2), range(FAULT_SEEDS)))
    seconds = [reaction.seconds for reaction in reactions]
    figures[name] = {"median_s": round(statistics.median(seconds), 3), "worst_s": round(max(seconds), 3)}
    assert [reaction for reaction in reactions if reaction.steady <= CREEP or reaction.blind] == []
    assert max(seconds) <= BOUND


def _told(drives: list[Drive]) -> dict[str, float]:
    speeds = [touch.speed for drive in drives for touch in drive.touches]
    return {
        "drives": len(drives),
        "way_m": round(sum(drive.way for drive in drives), 1),
        "nearest_m": round(min(drive.nearest for drive in drives), 3),
        "touches": len(speeds),
        "fastest_touch_m_s": round(max(speeds, default=0.0), 2),
    }
