"""A robot that sees by a laser scanner alone: posts, furniture, and faults of the scanner."""

import statistics
from collections.abc import Callable, Iterator
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
    _require_soft(partial(drive_at_post, seconds=_POST_S), range(first, first + 100), figures, "posts")


@pytest.mark.parametrize("first", range(0, WILD, 30))
def test_no_furniture_is_touched(first: int, figures: dict[str, Any]) -> None:
    _require_soft(partial(drive_wildly, seconds=_WILD_S), range(first, first + 30), figures, "wild")


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_stops_it_or_slows_it(name: str, figures: dict[str, Any]) -> None:
    with ProcessPoolExecutor() as pool:
        reactions: list[Reaction] = list(pool.map(partial(react, name, after=1.2), range(FAULT_SEEDS)))
    seconds = [reaction.seconds for reaction in reactions]
    figures[name] = {"median_s": round(statistics.median(seconds), 3), "worst_s": round(max(seconds), 3)}
    assert [reaction for reaction in reactions if reaction.steady <= CREEP or reaction.blind] == []
    assert max(seconds) <= BOUND


def _require_soft(drive: Callable[[int], Drive], seeds: range, figures: dict[str, Any], name: str) -> None:
    """Drive with these seeds, and note the figures."""
    with ProcessPoolExecutor() as pool:
        drives = list(pool.map(drive, seeds))
    speeds = [speed for made in drives for speed in made.touches]
    figures[f"{name}_from_{seeds[0]}"] = {
        "drives": len(drives),
        "way_m": round(sum(made.way for made in drives), 1),
        "nearest_m": round(min(made.nearest for made in drives), 3),
        "touches": len(speeds),
        "fastest_touch_m_s": round(max(speeds, default=0.0), 2),
    }
    assert [seed for seed, made in zip(seeds, drives, strict=True) if made.is_hard] == []
