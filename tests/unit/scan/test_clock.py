"""The scanner's clock: no packet that has waited counts, whatever kept it."""

from collections.abc import Iterable
from typing import Final

from giraff_scan.clock import DeviceClock

MS: Final = 1_000_000
BOOTED_NS: Final = 7_000_000 * MS
"""Robot's time when the scanner began to count."""


def told(clock: DeviceClock, sent_ms: Iterable[float], delay_ms: float = 3.0) -> list[float | None]:
    """Return ms by which each packet was older than it is told to be; None: it does not count."""
    ages = []
    for sent in sent_ms:
        measured = clock.measured_ns(int(sent) % 30_000, BOOTED_NS + round((sent + delay_ms) * MS))
        ages.append(None if measured is None else (measured - BOOTED_NS) / MS - sent)
    return ages


def period(begin: float, seconds: float, drift: float = 1.0) -> list[float]:
    """Return the moments of a packet each 2.67 ms, in ms."""
    return [begin + each * drift * 8.0 / 3.0 for each in range(round(seconds * 375))]


def settled(clock: DeviceClock) -> DeviceClock:
    told(clock, period(0.0, 1.1))
    return clock


def test_it_counts_once_the_earliest_offset_is_known_and_over_each_wrap() -> None:
    ages = told(DeviceClock(), period(28_500.0, 5.0))
    first = next(number for number, age in enumerate(ages) if age is not None)
    assert first * 8 / 3 == 1000.0
    known = [age for age in ages[first:] if age is not None]
    assert len(known) == len(ages) - first
    assert max(map(abs, known)) < 5.0


def test_what_an_adapter_has_held_is_old_or_dropped() -> None:
    clock = settled(DeviceClock())
    assert all(age is not None and abs(age) < 5.0 for age in told(clock, period(1100.0, 0.1), delay_ms=83.0))
    held = told(clock, period(1200.0, 0.3), delay_ms=203.0)
    assert held == [None] * len(held)
    assert clock.late == len(held)
    assert None not in told(clock, period(1500.0, 0.2))


def test_the_same_bytes_again_never_count() -> None:
    for length in (0.003, 0.05, 0.4, 0.9, 1.07, 1.9):
        clock = settled(DeviceClock())
        for again in range(round(6.0 / length)):
            ages = told(clock, period(0.2, length), delay_ms=1100.0 + 1000.0 * length * again)
            assert ages == [None] * len(ages)
        assert clock.repeated


def test_after_a_standstill_of_the_process_it_goes_on() -> None:
    for seconds in (0.1, 0.3, 2.0):
        assert None not in told(settled(DeviceClock()), period(1100.0 + 1000.0 * seconds, 0.1))


def test_another_start_of_the_scanner_is_found_out_and_believed_after_two_seconds() -> None:
    for restarted in (0.0, 17_000.0, 29_999.0):
        clock = settled(DeviceClock())
        ages = told(clock, period(restarted, 2.1), delay_ms=1100.0 + 700.0 - restarted)
        assert ages[:750] == [None] * 750
        assert ages[750] is not None
        assert ages[-1] is not None


def test_a_clock_that_goes_wrong_by_half_a_percent_is_followed() -> None:
    for drift in (0.995, 1.005):
        clock = DeviceClock()
        ages = []
        for number, sent in enumerate(period(0.0, 30.0, drift)):
            now = BOOTED_NS + round((number * 8.0 / 3.0 + 3.0) * MS)
            measured = clock.measured_ns(int(sent) % 30_000, now)
            ages.append(None if measured is None else (now - measured) / MS)
        known = [age for age in ages[375:] if age is not None]
        assert len(known) == len(ages) - 375
        assert min(known) > 4.9
        assert max(known) < 8.0


def test_what_was_held_for_longer_than_the_clock_tells_is_not_believed_at_once() -> None:
    for held in (14_000.0, 16_000.0, 29_999.0, 31_000.0):
        clock = settled(DeviceClock())
        ages = told(clock, period(1100.0, 0.3), delay_ms=held)
        assert ages == [None] * len(ages)
