"""A minute of driving over a bad link: each stop has its reason. `tests/timing/long` drives for ten."""

from collections.abc import Callable

import pytest

from tests.hosts.lab import Lab
from tests.timing.hosts.slow_link import ride, slow_link

Figure = Callable[[str, float, float, str], None]

SECONDS = 60.0
MOST_STOPS = 1.0


@pytest.mark.timeout(300)
def test_a_minute_over_a_bad_link(lab: Lab, figure: Figure) -> None:
    with slow_link(lab) as bulk:
        ridden = ride(lab, bulk, SECONDS)
    print(f"stops by stalls of this machine: {ridden.stalls}", *ridden.stops, sep="\n")
    ridden.require_reasons()
    told = f"10 Mbit/s, 20 ms, 2 % lost, bulk at {ridden.share:.0%} -> stops in {SECONDS:g} s"
    figure(told, len(ridden.stops), MOST_STOPS, "")
