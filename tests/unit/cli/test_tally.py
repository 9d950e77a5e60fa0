"""Samples counted by their makers' numbers: what is lost, late and double, and how often it was said."""

import dataclasses

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_tools.network.statistics import Arrival, Header, TopicStatistics

PERIOD_NS = 10_000_000


def arrival(seq: int | None, instance: str = "a", *, size: int = 50, late_ns: int = 0) -> Arrival:
    """A sample of a 100 Hz key, as it comes after `late_ns`; None: one that cannot be read."""
    at_ns = (seq or 0) * PERIOD_NS
    head = None if seq is None else Header(seq, at_ns, instance)
    return Arrival("odom", size, head, (at_ns + late_ns) * 1e-9, at_ns + late_ns)


def heard(*seqs: int) -> TopicStatistics:
    tally = TopicStatistics("odom")
    for seq in seqs:
        tally.on_sample(arrival(seq))
    return tally


def test_what_came_whole_is_counted_from_the_first_that_was_heard() -> None:
    count = heard(*range(1000, 1101)).counts["a"]
    assert (count.sent, count.heard, count.lost, count.reordered, count.duplicated) == (101, 101, 0, 0, 0)
    assert count.rate == pytest.approx(100.0)


@given(st.sets(st.integers(1, 98)), st.randoms(use_true_random=False))
def test_what_is_dropped_is_lost_whatever_the_order_of_the_rest(dropped: set[int], random: object) -> None:
    rest = [seq for seq in range(1, 99) if seq not in dropped]
    random.shuffle(rest)  # type: ignore[attr-defined]
    count = heard(0, *rest, 99).counts["a"]
    assert (count.sent, count.lost, count.heard) == (100, len(dropped), 100 - len(dropped))
    assert count.rate == pytest.approx(100.0)
    assert count.reordered == sum(seq < max(rest[:place], default=0) for place, seq in enumerate(rest))


def test_a_late_one_is_not_lost_and_a_double_counts_once() -> None:
    count = heard(5, 6, 8, 7, 7, 8, 9).counts["a"]
    assert (count.sent, count.heard, count.lost, count.reordered, count.duplicated) == (5, 5, 0, 1, 2)


def test_what_was_on_its_way_before_anybody_listened_counts_nothing() -> None:
    count = heard(5, 4, 6).counts["a"]
    assert (count.sent, count.heard, count.lost, count.reordered, count.duplicated) == (2, 2, 0, 0, 0)


def test_a_leap_of_the_numbers_takes_no_memory() -> None:
    count = heard(0, 1 << 60, (1 << 60) + 1).counts["a"]
    assert count.lost == (1 << 60) - 1
    assert len(count._missing) <= 10_000


def test_each_maker_has_its_own_numbers() -> None:
    tally = heard(0, 1, 2)
    tally.on_sample(arrival(0, "b"))
    tally.on_sample(arrival(None))
    assert {instance: count.lost for instance, count in tally.counts.items()} == {"a": 0, "b": 0}
    assert (tally.samples, tally.unreadable) == (5, 1)


def test_ages_and_sizes() -> None:
    tally = TopicStatistics("odom")
    for seq in range(101):
        tally.on_sample(arrival(seq, size=40 + seq % 3, late_ns=2_000_000 if seq else 30_000_000))
    ages = tally.counts["a"].ages
    assert (ages.quantile(0.5), ages.quantile(1.0)) == (2.0, 30.0)
    assert (tally.smallest, tally.largest) == (40, 42)
    assert tally.bytes_per_second == pytest.approx(4100.0, rel=0.05)


@pytest.mark.parametrize("leap", [3600.0, -3600.0, 0.0])
def test_a_leap_of_the_makers_clock_is_named_and_changes_no_rate(leap: float) -> None:
    tally = TopicStatistics("odom")
    for seq in range(2000):
        sample, head = arrival(seq), Header(seq, seq * PERIOD_NS + round(leap * 1e9) * (seq > 1700), "a")
        tally.on_sample(dataclasses.replace(sample, head=head))
    count = tally.counts["a"]
    assert count.rate == pytest.approx(100.0)
    assert count.rate_over(5.0) == pytest.approx(100.0)
    assert count.leap == pytest.approx(leap)


def test_few_samples_tell_no_rate() -> None:
    assert heard(1, 2).counts["a"].rate is None
    assert heard(1).bytes_per_second is None
