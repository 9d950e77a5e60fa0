"""Two thousand drives in which ultrasonic sensors go deaf, and an operator pushes on."""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from typing import Final

import msgspec

from tests.loop.deaf import BOUNDS, Outcome, figures, run, told
from tests.loop.touches import Kind
from tests.support.report import report

DRIVES: Final = 2000


def test_deaf() -> None:
    with ProcessPoolExecutor() as pool:
        outcomes = list(pool.map(run, range(DRIVES), chunksize=4))
    breaks = {o.drive.seed: [told(o, touch) for touch in o.breaks] for o in outcomes if o.breaks}
    found = {
        "drives": DRIVES,
        "rooms": Counter(outcome.drive.room for outcome in outcomes),
        "deaf": Counter(" and ".join(outcome.drive.deaf) for outcome in outcomes),
        "bounds": {str(kind): bound for kind, bound in BOUNDS.items()},
        "drives_with_a_touch": sum(_touches(outcome) for outcome in outcomes),
        "m_driven_with_a_deaf_sensor": round(sum(outcome.way for outcome in outcomes)),
        "touches": msgspec.to_builtins(figures(outcomes)),
        "breaks": breaks,
    }
    report("campaign/deaf", found)
    assert breaks == {}


def _touches(outcome: Outcome) -> bool:
    return any(touch.kind is not Kind.OTHER for touch in outcome.touches)
