"""What each operator is made of: which tick and counter its commands carry, and when it counts the robot as lost."""

from __future__ import annotations

import msgspec
import pytest

from giraff_core.lease import ASK, unranked_notice
from giraff_core.operator import ASKS_NOTHING, LINK_SILENCE, Operator
from giraff_schemas.messages import Lease, RobotTime, Tick


def heard(operator: Operator, ns: int, now: float) -> RobotTime:
    tick = Tick(epoch=1, robot_ns=ns)
    operator.on_tick(tick, now)
    return tick.time


def leased(holder: str, counter: int, seq: int = 0) -> Lease:
    return Lease(seq=seq, instance="guard", holder=holder, operator="hand", counter=counter, reason="held by another")


@pytest.fixture
def operator() -> Operator:
    return Operator("hand", "me")


def test_a_command_carries_the_tick_of_its_measurement_and_not_the_newest(operator: Operator) -> None:
    measured = heard(operator, 1, 0.0)
    heard(operator, 2, 0.02)
    assert operator.command(0.1, 0.0, tick=measured, wishes=True).tick == measured
    assert operator.command(0.1, 0.0, tick=operator.tick, wishes=True).tick == RobotTime(epoch=1, robot_ns=2)


def test_a_fault_asks_for_no_lost_lease_whatever_the_hand_wishes(operator: Operator) -> None:
    operator.on_lease(leased("me", 5))
    operator.on_lease(leased("other", 6, seq=1))
    assert operator.command(0.0, 0.1, tick=None, wishes=True).lease_counter == ASK
    assert operator.command(0.0, 0.0, tick=None, wishes=True, source="fault", reason="x").lease_counter == 5
    assert operator.fault("x", tick=None).lease_counter == 5


def test_one_that_does_not_ask_from_its_start_asks_by_a_wish_alone() -> None:
    operator = Operator("hand", "me", asks_from_start=False)
    assert operator.command(0.0, 0.0, tick=None, wishes=False).lease_counter == ASKS_NOTHING
    assert operator.command(0.1, 0.0, tick=None, wishes=True).lease_counter == ASK
    operator.on_lease(leased("me", 5))
    assert operator.command(0.0, 0.0, tick=None, wishes=False).lease_counter == 5


def test_the_robot_is_lost_after_half_a_second_without_a_newer_tick(operator: Operator) -> None:
    assert operator.link_fault(0.0)
    heard(operator, 2, 0.0)
    assert operator.link_fault(LINK_SILENCE) == ""
    heard(operator, 1, 0.1)  # an older one that has waited somewhere proves nothing
    assert operator.link_fault(LINK_SILENCE + 0.01)


def test_it_knows_who_drives(operator: Operator) -> None:
    operator.on_lease(leased("other", 6))
    assert (operator.holder, operator.holds) == ("hand", False)
    assert operator.refusal == "held by another"


def test_a_lease_that_was_given_up_is_asked_for_anew_and_counts_for_no_other_hand(operator: Operator) -> None:
    operator.on_lease(leased("me", 5))
    operator.give_up()
    for seq in (1, 2):  # the guard says it again, and has not heard
        assert not operator.holds
        assert "a new lease is asked for" in operator.refusal
        assert operator.command(0.0, 0.1, tick=None, wishes=True).lease_counter == ASK
        operator.on_lease(leased("me", 5, seq=seq))
        operator.give_up()
    operator.on_lease(leased("me", 6, seq=3))
    assert (operator.holds, operator.refusal) == (True, "")
    assert operator.command(0.1, 0.0, tick=None, wishes=True).lease_counter == 6


@pytest.mark.parametrize("holder", ["me", "other"])
def test_a_hand_hears_that_no_table_ranks_its_name_whoever_drives(operator: Operator, holder: str) -> None:
    lease = leased(holder, 6)
    operator.on_lease(msgspec.structs.replace(lease, unranked=("patrol",)))
    assert operator.rank_notice == ""
    operator.on_lease(msgspec.structs.replace(lease, seq=1, unranked=("patrol", "hand")))
    assert operator.rank_notice == unranked_notice("hand")
    assert (
        "any person's hand takes the robot from it; if a person drives by it, write `hand = 0`" in operator.rank_notice
    )
