"""A battery that runs down: half speed and a warning, then a stop; a dip under load is neither."""

from __future__ import annotations

import msgspec
import pytest

from giraff_base.battery import BatteryWatch
from giraff_core.live import Live
from giraff_schemas.trouble import WELL, Trouble
from tests.support.robots import DRIVE
from tests.unit.base.rig import CONFIG, Rig, moving

VOLTS_PER_COUNT = DRIVE.battery_volts_per_count


def charge(rig: Rig, volts: float) -> None:
    rig.board.battery_adc_counts = round(volts / VOLTS_PER_COUNT)


def test_a_low_battery_halves_the_speed_and_warns() -> None:
    rig = Rig()
    rig.drive(0.6)
    charge(rig, 21.6)
    assert rig.run(4.9)[-1].levels == (70, 70)
    assert rig.base.faults["battery"] == WELL
    assert rig.run(0.2)[-1].levels == (35, 35)
    assert rig.base.state().reason == "slowed: the battery is low at 21.6 V; charge it"
    assert rig.base.faults["battery"] == Trouble("the battery is low at 21.6 V", "charge it")
    assert rig.base.state().armed


def test_a_battery_that_rests_is_not_charged() -> None:
    rig = Rig()
    rig.drive(0.6)
    charge(rig, 21.6)
    rig.run(5.1)
    charge(rig, 22.4)
    assert rig.run(20.0)[-1].levels == (35, 35)
    charge(rig, 22.6)
    assert rig.run(4.9)[-1].levels == (35, 35)
    assert rig.run(1.0)[-1].levels == (70, 70)
    assert rig.base.faults["battery"] == WELL


def test_an_empty_battery_stops_after_5_s_until_it_is_charged_and_armed_again() -> None:
    rig = Rig()
    rig.drive(0.6)
    charge(rig, 19.8)
    assert rig.run(4.9)[-1].moves
    assert moving(rig.run(3.0)[20:]) == []
    state = rig.base.state()
    assert not state.armed
    assert state.reason == "the battery is empty at 19.8 V; charge it to 22 V"
    assert str(rig.base.faults["battery"]) == state.reason
    charge(rig, 21.9)  # it has recovered at rest
    rig.tilt(0.0)
    rig.run(20.0)
    assert not rig.base.state().armed
    rig.tilt(0.6)
    charge(rig, 24.0)
    assert moving(rig.run(10.0)) == []
    assert rig.base.state().reason.startswith("not armed since the battery is empty at")
    rig.drive(0.6)


@pytest.mark.parametrize("dip", [0.1, 1.0, 4.9])
def test_dips_under_load_neither_slow_nor_stop(dip: float) -> None:
    rig = Rig()
    rig.drive(0.6)
    for _ in range(5):
        charge(rig, 15.0)
        assert rig.run(dip)[-1].levels == (70, 70)
        charge(rig, 24.0)
        assert rig.run(0.05)[-1].levels == (70, 70)
    assert rig.base.faults["battery"] == WELL


def test_dips_on_both_sides_of_a_lost_link_are_two() -> None:
    rig = Rig()
    rig.drive(0.6)
    charge(rig, 15.0)
    rig.run(1.0)
    rig.base.on_link_lost(Trouble("unplugged"))
    rig.connected = False
    rig.run(5.0)
    rig.connected = True
    rig.base.on_link_opened(session=100)
    rig.run(1.0)
    assert rig.base.faults["battery"] == WELL


def test_a_link_that_comes_and_goes_does_not_hide_an_empty_battery() -> None:
    watch = BatteryWatch(Live(CONFIG))
    moment = 0
    stops = []
    for _ in range(6):
        for _ in range(100):
            moment += 10_000_000
            watch.take(19.0, moment)
        stops.append(bool(watch.stops))
        watch.pause()
        moment += 3_000_000_000
    assert stops == [False] * 5 + [True]


def test_a_battery_whose_divider_is_unknown_says_nothing() -> None:
    rig = Rig(drive=msgspec.structs.replace(DRIVE, battery_volts_per_count=0.0))
    rig.board.battery_adc_counts = 0
    rig.run(10.0)
    assert rig.base.faults["battery"] == WELL
    rig.drive(0.6)


def test_limits_that_are_off_never_apply() -> None:
    watch = BatteryWatch(Live(msgspec.structs.replace(CONFIG, battery_low=0.0, battery_cutoff=0.0)))
    for second in range(100):
        watch.take(0.0, second * 1_000_000_000)
    assert (watch.share, watch.warning, watch.stops) == (1.0, WELL, WELL)


def test_a_cutoff_alone_needs_half_a_volt_more_to_drive_again() -> None:
    watch = BatteryWatch(Live(msgspec.structs.replace(CONFIG, battery_low=0.0, battery_cutoff=20.0)))
    moment = 0
    for volts, stops in ((19.0, True), (20.4, True), (20.5, False)):
        for _ in range(10):
            moment += 1_000_000_000
            watch.take(volts, moment)
        assert bool(watch.stops) == stops
        assert watch.share == 1.0


def test_a_cutoff_above_low_is_refused() -> None:
    with pytest.raises(ValueError, match="battery_cutoff"):
        msgspec.structs.replace(CONFIG, battery_cutoff=22.5)
