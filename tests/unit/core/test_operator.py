"""What each operator is made of: which tick and counter its commands carry, and when it counts the robot as lost."""

from typing import Any

import msgspec
import pytest

from giraff_core.io import Inbox
from giraff_core.lease import ASK, unranked_notice
from giraff_core.operator import ASKS_NOTHING, LINK_SILENCE, Fault, Hand, Operator, OperatorService, Wish
from giraff_schemas.messages import DriveCommand, Lease, RobotTime, Tick
from giraff_schemas.topics import TICK, SampleT, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble


def heard(operator: Operator, ns: int, now: float) -> RobotTime:
    tick = Tick(epoch=1, robot_ns=ns)
    operator.on_tick(tick, now)
    return tick.time


def leased(holder: str, counter: int, seq: int = 0) -> Lease:
    return Lease(
        seq=seq, instance="guard", holder=holder, operator="hand", counter=counter, reason=Trouble("held by another")
    )


@pytest.fixture
def operator() -> Operator:
    return Operator("hand", "me")


def test_a_command_carries_the_tick_of_its_measurement_and_not_the_newest(operator: Operator) -> None:
    measured = heard(operator, 1, 0.0)
    heard(operator, 2, 0.02)
    assert operator.say(Wish(0.1, 0.0, measured, takes=True)).tick == measured
    assert operator.say(Wish(0.1, 0.0, operator.tick, takes=True)).tick == RobotTime(epoch=1, robot_ns=2)


def test_a_fault_asks_for_no_lost_lease_whatever_the_hand_wishes(operator: Operator) -> None:
    operator.on_lease(leased("me", 5))
    operator.on_lease(leased("other", 6, seq=1))
    assert operator.say(Wish(0.0, 0.1, None, takes=True)).lease_counter == ASK
    assert operator.say(Fault(Trouble("x"), None)).lease_counter == 5


def test_one_that_does_not_ask_from_its_start_asks_by_a_wish_alone() -> None:
    operator = Operator("hand", "me", asks_from_start=False)
    assert operator.say(Wish(0.0, 0.0, None)).lease_counter == ASKS_NOTHING
    assert operator.say(Wish(0.1, 0.0, None, takes=True)).lease_counter == ASK
    operator.on_lease(leased("me", 5))
    assert operator.say(Wish(0.0, 0.0, None)).lease_counter == 5


def test_the_robot_is_lost_after_half_a_second_without_a_newer_tick(operator: Operator) -> None:
    assert operator.link_fault(0.0)
    heard(operator, 2, 0.0)
    assert operator.link_fault(LINK_SILENCE) == NO_TROUBLE
    heard(operator, 1, 0.1)  # an older one that has waited somewhere proves nothing
    assert operator.link_fault(LINK_SILENCE + 0.01)


def test_it_knows_who_drives(operator: Operator) -> None:
    operator.on_lease(leased("other", 6))
    assert (operator.holder, operator.holds) == ("hand", False)
    assert operator.refusal == Trouble("held by another")


def test_a_lease_that_was_given_up_is_asked_for_anew_and_counts_for_no_other_hand(operator: Operator) -> None:
    operator.on_lease(leased("me", 5))
    operator.give_up()
    for seq in (1, 2):  # the guard says it again, and has not heard
        assert not operator.holds
        assert operator.refusal.action == "hold_level"
        assert operator.say(Wish(0.0, 0.1, None, takes=True)).lease_counter == ASK
        operator.on_lease(leased("me", 5, seq=seq))
        operator.give_up()
    operator.on_lease(leased("me", 6, seq=3))
    assert (operator.holds, operator.refusal) == (True, NO_TROUBLE)
    assert operator.say(Wish(0.1, 0.0, None, takes=True)).lease_counter == 6


@pytest.mark.parametrize("holder", ["me", "other"])
def test_a_hand_hears_that_no_table_ranks_its_name_whoever_drives(operator: Operator, holder: str) -> None:
    lease = leased(holder, 6)
    operator.on_lease(msgspec.structs.replace(lease, unranked=("patrol",)))
    assert operator.rank_notice == NO_TROUBLE
    operator.on_lease(msgspec.structs.replace(lease, seq=1, unranked=("patrol", "hand")))
    assert operator.rank_notice == unranked_notice("hand")
    assert "if a person drives by it, write `hand = 0`" in operator.rank_notice.remedy


class Lever(Hand):
    """A device that is moved, and then says so."""

    def __init__(self) -> None:
        super().__init__(Operator("lever", "me", asks_from_start=False))
        self.moved: RobotTime | None = None
        self.fault = NO_TROUBLE

    def read(self, now: float) -> bool:
        del now
        return self.moved is not None

    def poll(self, now: float) -> Wish | Fault | None:
        del now
        if self.fault:
            return Fault(self.fault, self.moved)
        return Wish(0.2, 0.0, self.moved, takes=True) if self.moved else None


class Room:
    """All that an operator reaches, and what it told."""

    def __init__(self) -> None:
        self.inboxes: dict[str, Inbox[Any]] = {}
        self.told: dict[str, Trouble] = {}
        self.said: list[DriveCommand] = []
        self.lost_parameters = NO_TROUBLE

    def inbox(self, topic: Topic[SampleT], limit: int = 200, *, wakes: bool = True) -> Inbox[SampleT]:
        del wakes
        return self.inboxes.setdefault(topic.key, Inbox(limit))

    def publisher(self, topic: Topic[Any]) -> Any:
        assert topic.key == "cmd_vel/lever"
        return self

    def put(self, command: DriveCommand) -> None:
        self.said.append(command)

    def set_notice(self, name: str, trouble: Trouble) -> None:
        self.told[name] = trouble


def test_a_saved_limit_that_may_be_lost_stops_the_hand_and_is_told() -> None:
    room, lever = Room(), Lever()
    room.lost_parameters = Trouble("no parameter has the name of what was saved", "remove the file")
    service = OperatorService(room, lever)
    room.inbox(TICK).accept(Tick(epoch=1, robot_ns=1))
    lever.moved = RobotTime(epoch=1, robot_ns=1)
    service.turn(0.0)
    assert [(said.source, said.linear_x, said.reason) for said in room.said] == [("fault", 0.0, room.lost_parameters)]
    assert room.told["hand"] == lever.operator.fault(0.0) == room.lost_parameters


def test_a_service_says_what_its_hand_asks_and_tells_why_it_is_not_obeyed() -> None:
    room, lever = Room(), Lever()
    service = OperatorService(room, lever)
    for step in range(10):
        room.inbox(TICK).accept(Tick(epoch=1, robot_ns=step + 1))
        service.turn(step * 0.02)
    service.end()
    assert (room.said, room.told) == ([], {}), "a hand that has nothing to say asks for nothing, and has no last words"
    lever.moved = lever.operator.tick
    room.inbox(TICK).accept(Tick(epoch=1, robot_ns=100))
    service.turn(0.181)
    assert [(said.linear_x, said.lease_counter, said.tick) for said in room.said] == [(0.2, ASK, lever.moved)]
    assert "the guard is not heard" in room.told["lease"].what
    lever.fault = Trouble("it is jammed", "oil it")
    service.turn(0.2)
    service.end()
    fault, last = room.said[1:]
    assert (fault.source, fault.reason) == ("fault", lever.fault)
    assert room.told["hand"] == lever.fault
    assert (last.source, last.linear_x, last.tick, last.reason.remedy) == ("fault", 0.0, lever.moved, "start it again")
