"""Ten minutes of driving over a bad link, from one host to another."""

from __future__ import annotations

import subprocess
from contextlib import closing

from giraff_sim.board import ROOT
from tests.campaign.records import PROCESSES, ROBOT, judged, write_record
from tests.hosts.bad_cable import BAD
from tests.hosts.lab import Lab
from tests.hosts.slow_link import ride, slow_link

SECONDS = 600.0
MOST_STOPS = 1


def test_ten_minutes_over_a_bad_link() -> None:
    subprocess.run([ROOT / "tests" / "hosts" / "prepare"], check=True)
    with closing(Lab()) as lab, slow_link(lab) as bulk:
        ridden = ride(lab, bulk, SECONDS)
    path = write_record(
        "slow-link",
        {
            "cable": BAD._asdict(),
            "bulk_share": round(ridden.share, 3),
            "seconds": SECONDS,
            "stops_by_stalls_of_this_machine": ridden.stalls,
            "stops": [stop._asdict() for stop in ridden.stops],
        },
        judged(__name__, *PROCESSES, also=(*ROBOT, "Dockerfile", "docker-compose.yml", "deploy/env")),
    )
    print(path.read_text())
    ridden.require_reasons()
    assert len(ridden.stops) <= MOST_STOPS
