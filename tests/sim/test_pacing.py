"""Simulated time beside the wall's."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_sim.simulation import WallPacer


def test_on_time_it_waits_out_the_slice() -> None:
    pacer = WallPacer()
    assert pacer.wait(100.0, 5_000) == 0.0
    assert pacer.wait(100.0002, 6_000) == pytest.approx(0.0008)
    assert pacer.wait(100.001, 7_000) == pytest.approx(0.001)


def test_a_little_late_it_makes_up_without_a_burst_of_more_than_50_ms() -> None:
    pacer = WallPacer()
    pacer.wait(0.0, 0)
    assert pacer.wait(0.049, 1_000) == 0.0
    assert pacer.skew == 0.0
    assert pacer.wait(0.049, 50_000) == pytest.approx(0.001)


def test_very_late_it_slips_and_counts() -> None:
    pacer = WallPacer()
    pacer.wait(0.0, 0)
    assert pacer.wait(1.0, 1_000) == 0.0
    assert pacer.skew == pytest.approx(0.999)
    assert pacer.slips == 1
    assert pacer.wait(1.0, 2_000) == pytest.approx(0.001)


@given(st.lists(st.floats(0.0, 0.4), max_size=60))
def test_no_stall_is_followed_by_a_burst(stalls: list[float]) -> None:
    pacer = WallPacer()
    wall, simulated = 0.0, 0
    pacer.wait(wall, simulated)
    for stall in stalls:
        before = wall
        wall += stall
        simulated += 1000
        wall += pacer.wait(wall, simulated)
        assert wall >= before
        behind = wall - simulated * 1e-6
        assert behind - pacer.skew <= 0.05 + 1e-9
