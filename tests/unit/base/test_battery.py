"""A battery that runs down: half speed and a warning, then the emergency stop; a dip under load is neither."""

from random import Random

import msgspec
import pytest

from giraff_base.battery import BatteryWatch
from giraff_base.estop import RELEASED, EStopLatch
from giraff_core.live import Live
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import Latch
from tests.support.robots import DRIVE
from tests.unit.base.rig import CONFIG, Rig, moving

VOLTS_PER_COUNT = DRIVE.battery_volts_per_count


def charge(rig: Rig, volts: float) -> None:
    rig.board.battery_adc_counts = round(volts / VOLTS_PER_COUNT)


def test_a_low_battery_halves_the_speed_and_warns(driven: Rig) -> None:
    charge(driven, 21.6)
    assert driven.run(4.9)[-1].levels == (70, 70)
    assert driven.base.faults["battery"] == NO_TROUBLE
    assert driven.run(0.2)[-1].levels == (35, 35)
    assert str(driven.base.state().reason) == "slowed: the battery is low at 21.6 V; charge it"
    assert driven.base.faults["battery"] == Trouble("the battery is low at 21.6 V", "charge it")
    assert driven.base.state().armed


def test_a_battery_that_rests_is_not_charged(driven: Rig) -> None:
    charge(driven, 21.6)
    driven.run(5.1)
    charge(driven, 22.4)
    assert driven.run(6.0)[-1].levels == (35, 35)
    charge(driven, 22.6)
    assert driven.run(4.9)[-1].levels == (35, 35)
    assert driven.run(1.0)[-1].levels == (70, 70)
    assert driven.base.faults["battery"] == NO_TROUBLE


EMPTY = "the battery is empty at 19.8 V; charge it to 22 V, then run `giraff estop reset` to release it"


def emptied(latch: EStopLatch = RELEASED) -> Rig:
    """A robot that has driven until its battery was empty."""
    rig = Rig(latch=latch)
    rig.drive(0.6)
    charge(rig, 19.8)
    assert rig.run(4.9)[-1].moves
    assert moving(rig.run(0.5)[20:]) == []
    return rig


def reset(rig: Rig) -> EStopAnswer:
    """Have a person reset the emergency stop that is in force."""
    latch = rig.base.latch
    return rig.base.on_reset(EStopReset(by="kim", id=latch.id, tick=rig.now), rig.now)


def test_an_empty_battery_engages_the_emergency_stop_once_and_only_a_charged_one_lets_it_be_reset() -> None:
    rig = emptied()
    latch = rig.base.latch
    assert (latch.engaged, latch.by, str(latch.reason)) == (True, "battery", EMPTY)
    assert not rig.base.state().armed
    assert str(rig.base.state().reason) == f"emergency stop by battery: {EMPTY}"
    assert rig.board.latch == Latch.ESTOP
    assert (answer := reset(rig)).engaged
    assert str(answer.reason) == "the battery is empty at 19.8 V; charge it to 22 V"
    charge(rig, 21.9)  # it has recovered at rest
    rig.tilt(0.0)
    rig.run(6.0)
    assert reset(rig).engaged
    charge(rig, 24.0)
    rig.run(5.1)
    assert rig.base.latch == latch, "it stays until somebody resets it, and no second one follows"
    assert not reset(rig).engaged
    rig.tilt(0.6)
    assert moving(rig.run(1.0)) == [], "a reset moves nothing"
    rig.drive(0.6)


@pytest.mark.parametrize(("volts", "refused"), [(21.9, True), (24.0, False)])
def test_the_stop_outlives_a_restart_and_goes_by_the_volts_of_then(volts: float, refused: bool) -> None:
    latch = emptied().base.latch
    rig = Rig(latch=latch)
    rig.connected = False
    rig.run(1.0)
    assert (
        str(reset(rig).reason) == "the battery was empty and is not measured now; connect the base board, then reset it"
    )
    rig.connected = True
    charge(rig, volts)
    rig.run(5.2)
    assert rig.base.latch == latch
    assert reset(rig).engaged == refused


@pytest.mark.parametrize("is_restarted", [False, True])
@pytest.mark.parametrize("is_first", [False, True])
def test_a_stop_of_a_person_does_not_hide_that_the_battery_was_empty(is_first: bool, is_restarted: bool) -> None:
    rig = Rig() if is_first else emptied()
    rig.base.on_engage(EStopEngage(by="kim", reason=Trouble("look")), rig.now)
    charge(rig, 19.8)
    rig.run(5.5)
    assert rig.base.latch.by == ("battery" if is_first else "kim")
    if is_restarted:
        rig = Rig(latch=rig.base.latch)
        rig.base.on_engage(EStopEngage(by="kim", reason=Trouble("before the board is heard")), rig.now)
        rig = Rig(latch=rig.base.latch)
        charge(rig, 21.0)
        rig.run(0.5)
    assert reset(rig).engaged
    charge(rig, 24.0)
    rig.run(5.2)
    assert not reset(rig).engaged
    rig.run(6.0)
    assert not rig.base.latch.engaged


def test_a_battery_without_a_divider_lets_its_old_stop_be_reset() -> None:
    rig = Rig(latch=emptied().base.latch, drive=msgspec.structs.replace(DRIVE, battery_volts_per_count=0.0))
    rig.run(1.0)
    assert not reset(rig).engaged


def test_a_charge_is_a_volt_more_of_a_robot_that_rests_and_nothing_else() -> None:
    watch, moment, seen, chance = BatteryWatch(Live(CONFIG)), 0, [], Random(1)
    for volts, rests, lasts in (
        (24.0, True, 3),
        (22.5, False, 3),  # it drives,
        (23.9, True, 3),  # and has recovered
        (22.9, True, 3),
        (23.95, True, 1),  # charged
        (26.0, True, 1),  # and more
        (23.0, False, 6),
        (25.5, True, 54),
    ):
        for _ in range(60 * lasts):
            moment += 1
            watch.on_voltage(volts + chance.gauss(0.0, 0.15), moment * 1_000_000_000, rests=rests)
        seen.append(watch.since_charge)
    assert seen[:4] == [None] * 4
    assert seen[4:] == pytest.approx([0.0, 0.0, 360.0, 3600.0], abs=61.0)


@pytest.mark.parametrize("dip", [0.1, 4.9])
def test_dips_under_load_neither_slow_nor_stop(driven: Rig, dip: float) -> None:
    for _ in range(2):
        charge(driven, 15.0)
        assert driven.run(dip)[-1].levels == (70, 70)
        charge(driven, 24.0)
        assert driven.run(dip)[-1].levels == (70, 70)
    assert driven.base.faults["battery"] == NO_TROUBLE


def test_a_robot_that_stops_again_and_again_does_not_hide_an_empty_battery(driven: Rig) -> None:
    for _ in range(2):
        charge(driven, 17.0)
        driven.run(4.5)
        charge(driven, 20.2)
        driven.run(0.5)
    assert driven.base.latch.by == "battery"


def test_a_base_that_stood_still_takes_no_dip_before_it_for_an_empty_battery(driven: Rig) -> None:
    charge(driven, 15.0)
    driven.run(0.6)
    driven.robot_ns += 6_000_000_000
    driven.step()  # what has waited
    charge(driven, 25.0)
    driven.run(1.0)
    assert not driven.base.latch.engaged


def test_dips_on_both_sides_of_a_lost_link_are_two(driven: Rig) -> None:
    charge(driven, 15.0)
    driven.run(1.0)
    driven.base.on_link_lost(Trouble("unplugged"))
    driven.connected = False
    driven.run(5.0)
    driven.connected = True
    driven.base.on_link_opened(session=100)
    driven.run(1.0)
    assert driven.base.faults["battery"] == NO_TROUBLE


def test_a_link_that_comes_and_goes_does_not_hide_an_empty_battery() -> None:
    watch = BatteryWatch(Live(CONFIG))
    moment = 0
    stops = []
    for _ in range(6):
        for _ in range(100):
            moment += 10_000_000
            watch.on_voltage(19.0, moment, rests=False)
        stops.append(bool(watch.stops))
        moment += 3_000_000_000
    assert stops == [False] * 5 + [True]


def test_a_battery_whose_divider_is_unknown_says_nothing() -> None:
    rig = Rig(drive=msgspec.structs.replace(DRIVE, battery_volts_per_count=0.0))
    rig.board.battery_adc_counts = 0
    rig.run(6.0)
    assert rig.base.faults["battery"] == NO_TROUBLE
    rig.drive(0.6)


def test_limits_that_are_off_never_apply() -> None:
    watch = BatteryWatch(Live(msgspec.structs.replace(CONFIG, battery_low=0.0, battery_cutoff=0.0)))
    for second in range(100):
        watch.on_voltage(0.0, second * 1_000_000_000, rests=False)
    assert (watch.share, watch.warning, watch.stops) == (1.0, NO_TROUBLE, NO_TROUBLE)


def test_a_cutoff_alone_needs_half_a_volt_more_to_drive_again() -> None:
    watch = BatteryWatch(Live(msgspec.structs.replace(CONFIG, battery_low=0.0, battery_cutoff=20.0)))
    moment = 0
    for volts, stops in ((19.0, True), (20.4, True), (20.5, False)):
        for _ in range(10):
            moment += 1_000_000_000
            watch.on_voltage(volts, moment, rests=False)
        assert bool(watch.stops) == stops
        assert watch.share == 1.0


def test_a_cutoff_above_low_is_refused() -> None:
    with pytest.raises(ValueError, match="battery_cutoff"):
        msgspec.structs.replace(CONFIG, battery_cutoff=22.5)
