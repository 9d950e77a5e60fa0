"""Two thousand drives in which ultrasonic sensors go deaf, and an operator pushes on."""

from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Final

import msgspec
import pytest

from tests.loop.deaf import BOUNDS, Outcome, figures, run, told
from tests.loop.touches import Kind
from tests.support.report import report

DRIVES: Final = 2000
LEG: Final = 40
"""Drives of one test."""


@pytest.fixture(scope="module")
def outcomes() -> Iterator[list[Outcome]]:
    """The outcomes of all legs that ran, reported at their end."""
    made: list[Outcome] = []
    yield made
    found = {
        "drives": len(made),
        "rooms": Counter(outcome.drive.room for outcome in made),
        "deaf": Counter(" and ".join(outcome.drive.deaf) for outcome in made),
        "bounds": {str(kind): bound for kind, bound in BOUNDS.items()},
        "drives_with_a_touch": sum(_touches(outcome) for outcome in made),
        "m_driven_with_a_deaf_sensor": round(sum(outcome.way for outcome in made)),
        "touches": msgspec.to_builtins(figures(made)),
        "breaks": _breaks(made),
    }
    report("campaign/deaf", found)


@pytest.mark.parametrize("first", range(0, DRIVES, LEG))
def test_deaf(first: int, outcomes: list[Outcome]) -> None:
    with ProcessPoolExecutor() as pool:
        leg = list(pool.map(run, range(first, first + LEG), chunksize=4))
    outcomes += leg
    assert _breaks(leg) == {}


def _breaks(outcomes: list[Outcome]) -> dict[int, list[str]]:
    return {o.drive.seed: [told(o, touch) for touch in o.breaks] for o in outcomes if o.breaks}


def _touches(outcome: Outcome) -> bool:
    return any(touch.kind is not Kind.OTHER for touch in outcome.touches)
