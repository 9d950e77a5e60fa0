"""Ten minutes of driving over a bad link, from one host to another."""

import subprocess
from contextlib import closing

import pytest

from giraff_sim.board import ROOT
from tests.hosts.bad_cable import BAD
from tests.hosts.lab import Lab
from tests.support.report import report
from tests.timing.hosts.slow_link import ride, slow_link

SECONDS = 600.0
MOST_STOPS = 1


@pytest.mark.timeout(0)
def test_ten_minutes_over_a_bad_link() -> None:
    subprocess.run([ROOT / "tests" / "hosts" / "prepare"], check=True)
    with closing(Lab()) as lab, slow_link(lab) as bulk:
        ridden = ride(lab, bulk, SECONDS)
    report(
        "timing/slow-link",
        {
            "cable": BAD._asdict(),
            "bulk_share": round(ridden.share, 3),
            "seconds": SECONDS,
            "stops_by_stalls_of_this_machine": ridden.stalls,
            "stops": [stop._asdict() for stop in ridden.stops],
        },
    )
    ridden.require_reasons()
    assert len(ridden.stops) <= MOST_STOPS
