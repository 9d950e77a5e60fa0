"""The page of docs says what the results say, and a run that is over a limit says so."""

from __future__ import annotations

import json

import pytest

from bench.__main__ import PAGE, PICTURES, RESULTS
from bench.figures import LIMITS, Figures, Limit, as_json, from_json
from bench.pictures import pictures
from bench.report import page, tables
from bench.robot import plan
from giraff_schemas.services import GUARD, RANGER

_ABOUT = {"date": "2026-01-01", "rounds": 2, "machine": {"cores": "2 cores"}, "versions": {"msgspec": "0.1"}}


def test_page_and_pictures_are_of_the_results() -> None:
    results = json.loads(RESULTS.read_text())
    text = PAGE.read_text()
    assert page(text, results) == text
    drawn = pictures(from_json(results["figures"]))
    assert drawn == {name: (PICTURES / name).read_text() for name in drawn}


def test_every_limit_is_measured() -> None:
    """A limit whose figure has another name would hold for ever."""
    figures = from_json(json.loads(RESULTS.read_text())["figures"])
    assert [limit for limit, _, _ in figures.judged()] == [*LIMITS]


@pytest.mark.parametrize(("value", "is_over"), [(118.0, False), (122.0, True)])
def test_what_is_over_its_limit_is_marked(value: float, is_over: bool) -> None:
    figures = Figures()
    for raw in (100.0, 50.0):  # of each round its own ratio
        figures.add("round trip p50", "raw", raw)
        figures.add("round trip p50", "node", raw * value / 100.0)
    told = tables({**_ABOUT, "figures": as_json(figures)})
    assert ("**over**" in told) == is_over
    assert ("All limits hold." in told) != is_over


def test_a_ratio_of_which_more_is_better_has_its_limit_below() -> None:
    figures = Figures({"burst": {"raw": [100.0], "node": [49.0]}})
    assert figures.judged() == [(Limit("burst", "node", "least of raw", 0.5), 0.49, False)]


def test_the_traffic_of_a_service_is_that_of_its_row() -> None:
    keys = [key for key, *_ in plan(RANGER)["publish"]]
    assert keys == ["range/front_left", "range/front_right", "range/rear"]
    assert plan(GUARD)["subscribe"] == ["tick", "range/*", "wheels", "cmd_vel/*"]
