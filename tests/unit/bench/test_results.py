"""The page of docs says what the results say, and a run that misses a target says so."""

import json

import pytest

from bench.__main__ import PAGE, PICTURES, RESULTS, main
from bench.figures import TARGETS, Figures, Target, as_json, from_json
from bench.pictures import pictures
from bench.report import page, tables
from bench.robot import plan
from giraff_schemas.services import GUARD, RANGER

_ABOUT = {
    "date": "2026-01-01",
    "commit": "0123abc",
    "rounds": 2,
    "machine": {"cores": "2 cores"},
    "versions": {"msgspec": "0.1"},
}


def test_page_and_pictures_are_of_the_results() -> None:
    results = json.loads(RESULTS.read_text())
    text = PAGE.read_text()
    assert page(text, results) == text, "run `make bench`"
    drawn = pictures(from_json(results["figures"]))
    assert drawn == {name: (PICTURES / name).read_text() for name in drawn}, "run `make bench`"


def test_every_target_is_measured() -> None:
    """A target whose figure has another name would never be missed."""
    figures = from_json(json.loads(RESULTS.read_text())["figures"])
    assert [target for target, _, _ in figures.judged()] == [*TARGETS], "run `make bench`"


@pytest.mark.parametrize(("value", "shown", "is_missed"), [(120.0, "1.2", False), (120.4, "1.204", True)])
def test_a_missed_target_is_marked_with_digits_that_show_it(value: float, shown: str, is_missed: bool) -> None:
    figures = Figures()
    for raw in (100.0, 50.0):  # of each round its own ratio
        figures.add("round trip p50", "raw", raw)
        figures.add("round trip p50", "node", raw * value / 100.0)
    told = tables({**_ABOUT, "figures": as_json(figures)})
    assert f"| {shown} " in told
    assert ("**missed**" in told) == is_missed
    assert (f"- round trip, p50, µs, node: {shown}, target: most 1.2 of raw" in told) == is_missed
    assert ("All measured targets are reached." in told) != is_missed


def test_a_run_that_measured_no_target_says_so() -> None:
    told = tables({**_ABOUT, "figures": as_json(Figures({"codec": {"tick, a Node": [1.0]}}))})
    assert told.endswith("No target was measured.")


@pytest.mark.parametrize("rounds", ["0", "-1", "x"])
def test_a_run_without_a_round_is_refused(
    rounds: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["bench", "--rounds", rounds])
    with pytest.raises(SystemExit):
        main()
    assert f"argument --rounds: '{rounds}' is no number of rounds" in capsys.readouterr().err


def test_a_ratio_of_which_more_is_better_has_its_target_below() -> None:
    figures = Figures({"burst": {"raw": [100.0], "node": [49.0]}})
    assert figures.judged() == [(Target("burst", "node", "least of raw", 0.5), 0.49, False)]


def test_the_traffic_of_a_service_is_that_of_its_row() -> None:
    keys = [key for key, *_ in plan(RANGER)["publish"]]
    assert keys == ["range/front_left", "range/front_right", "range/rear"]
    assert plan(GUARD)["subscribe"] == ["tick", "range/*", "wheels", "cmd_vel/*"]
