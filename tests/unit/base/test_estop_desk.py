"""Between asking, memory and disk: a stop never waits for the disk, and nothing is permitted that is not on it."""

from collections import deque
from typing import Generic, TypeVar

import pytest

from giraff_base.estop import RELEASED, EStopLatch
from giraff_base.estop_server import EStopServer
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import EstopFrame, Latch
from tests.support.robots import DRIVE
from tests.unit.base.rig import Rig, moving

RequestT = TypeVar("RequestT")
FULL = "estop.json: No space left on device"


class Disk:
    """Keeps latches when it is told to."""

    def __init__(self) -> None:
        self.content = RELEASED
        self.trouble = ""
        self.hangs = False
        self.writes = 0
        self.touched = False
        """Something was to be written since this was last set."""
        self._wanted: EStopLatch | None = None
        self._outcomes: deque[tuple[EStopLatch, str]] = deque()

    def save(self, latch: EStopLatch) -> None:
        assert self._wanted is None, "one at a time"
        self._wanted = latch
        self.touched = True

    def work(self) -> None:
        """What its thread does meanwhile."""
        if self._wanted is None or self.hangs:
            return
        self.writes += 1
        if not self.trouble:
            self.content = self._wanted
        self._outcomes.append((self._wanted, self.trouble))
        self._wanted = None

    def outcome(self) -> tuple[EStopLatch, str] | None:
        return self._outcomes.popleft() if self._outcomes else None


class Asked(Generic[RequestT]):
    """A request whose answers are kept."""

    def __init__(self, request: RequestT) -> None:
        self.request = request
        self.answers: list[EStopAnswer] = []

    def answer(self, answer: EStopAnswer) -> None:
        self.answers.append(answer)

    @property
    def only(self) -> EStopAnswer:
        (answer,) = self.answers
        return answer


class Office:
    """A robot, its disk and the desk in front of both."""

    def __init__(self) -> None:
        self.rig = Rig()
        self.disk = Disk()
        self.desk = EStopServer(self.rig.base, self.disk, "base-1")
        self.go_on()

    def go_on(self, seconds: float = 0.03) -> None:
        for _ in range(round(seconds * 100)):
            self.rig.step()
            self.desk.turn(self.rig.now)
            self.disk.work()
            # After the disk, too: here no turn of the loop is lost by waiting for the next.
            self.desk.turn(self.rig.now)

    def engage(self, by: str = "keyboard") -> Asked[EStopEngage]:
        asked = Asked(EStopEngage(by=by, reason=Trouble("space bar")))
        self.desk.on_requests([asked], [], self.rig.now)
        return asked

    def reset(self, age: float = 0.0) -> Asked[EStopReset]:
        asked = Asked(EStopReset(by="carer", id=self.rig.base.latch.id, tick=self.rig.ago(age)))
        self.desk.on_requests([], [asked], self.rig.now)
        return asked


@pytest.fixture
def office() -> Office:
    return Office()


@pytest.fixture
def stopped(office: Office) -> Office:
    """Its stop is confirmed and on disk."""
    first = office.engage()
    office.go_on()
    assert first.only.done
    return office


def test_at_its_start_base_writes_what_is_in_force_and_so_finds_a_bad_disk() -> None:
    assert Office().disk.writes == 1
    office = Office()
    office.disk.trouble = FULL
    bad = EStopServer(office.rig.base, office.disk, "base-1")
    bad.turn(office.rig.now)
    office.disk.work()
    bad.turn(office.rig.now)
    assert "No space left" in str(bad.fault)


def test_engaging_stops_before_the_disk_is_touched_and_is_confirmed_once_it_is_on_it(office: Office) -> None:
    office.rig.drive(0.6)
    office.disk.hangs, office.disk.touched = True, False
    asked = office.engage()
    assert office.rig.base.latch.engaged
    assert isinstance(office.rig.base.next_frame(office.rig.now), EstopFrame)
    assert not office.disk.touched
    office.go_on(0.5)
    assert asked.answers == []
    assert office.disk.content == RELEASED
    office.disk.hangs = False
    office.go_on()
    assert (asked.only.done, asked.only.engaged, asked.only.id) == (True, True, office.rig.base.latch.id)
    assert (asked.only.instance, asked.only.unheard_stops_s) == ("base-1", 0.0)
    assert office.disk.content == office.rig.base.latch
    assert office.desk.fault == NO_TROUBLE


@pytest.mark.parametrize(("silent", "unheard"), [(None, 0.3), (0.14, 0.0), (0.16, 0.3)])
def test_base_tells_who_stops_it_that_it_does_not_hear_its_board(
    office: Office, silent: float | None, unheard: float
) -> None:
    if silent is None:
        office.rig.base.on_link_lost(Trouble("no such port"))
    office.rig.robot_ns += round((silent or 0.0) * 1e9)
    asked = office.engage()
    office.desk.turn(office.rig.now)
    office.disk.work()
    office.desk.turn(office.rig.now)
    assert (asked.only.done, asked.only.unheard_stops_s) == (True, unheard)


def test_the_same_stop_again_while_its_release_is_being_written_waits_for_what_becomes_of_that(stopped: Office) -> None:
    reset = stopped.reset()
    stopped.desk.turn(stopped.rig.now)  # the released latch is on its way to the disk
    again = stopped.engage()
    stopped.desk.turn(stopped.rig.now)
    assert not reset.only.done
    assert again.answers == []
    stopped.disk.work()
    assert not stopped.disk.content.engaged
    stopped.desk.turn(stopped.rig.now)
    assert again.answers == []
    stopped.go_on()
    assert again.only.done
    assert stopped.disk.content == stopped.rig.base.latch
    assert stopped.disk.content.engaged


def test_the_same_stop_again_is_written_again_since_a_second_base_may_have_written_a_release(stopped: Office) -> None:
    stopped.disk.content = RELEASED
    again = stopped.engage()
    stopped.desk.turn(stopped.rig.now)
    assert again.answers == []
    stopped.go_on()
    assert again.only.done
    assert stopped.disk.content == stopped.rig.base.latch
    assert stopped.disk.content.engaged


def test_a_full_disk_keeps_the_robot_stopped_says_so_and_is_tried_again(office: Office) -> None:
    office.rig.drive(0.6)
    office.disk.trouble = FULL
    asked = office.engage()
    office.go_on()
    assert (asked.only.done, asked.only.engaged) == (False, True)
    assert FULL in str(asked.only.reason)
    assert "free the disk" in str(asked.only.reason)
    assert FULL in str(office.desk.fault)
    assert moving(office.rig.run(1.0)) == []
    writes = office.disk.writes
    office.go_on(5.0)
    assert 40 <= office.disk.writes - writes <= 50


def test_a_stop_is_on_a_disk_that_works_again_whether_or_not_anybody_asks_again(office: Office) -> None:
    """Who asked may be cut off, and the robot may lose its power in the next second."""
    office.disk.trouble = FULL
    office.engage()
    office.go_on(2.3)
    assert not office.disk.content.engaged
    office.disk.trouble = ""
    office.go_on(0.12)
    assert office.disk.content == office.rig.base.latch
    assert office.desk.fault == NO_TROUBLE


def test_asking_again_on_a_mended_disk_is_confirmed_at_once(office: Office) -> None:
    office.disk.trouble = FULL
    office.engage()
    office.go_on()
    office.disk.trouble = ""
    again = office.engage()
    office.go_on()
    assert again.only.done


def test_a_reset_is_on_disk_before_it_permits_anything(stopped: Office) -> None:
    stopped.disk.hangs = True
    asked = stopped.reset()
    stopped.go_on(0.5)
    assert asked.answers == []
    assert stopped.rig.base.latch.engaged
    assert stopped.rig.board.latch == Latch.ESTOP
    stopped.disk.hangs = False
    stopped.go_on()
    assert (asked.only.done, asked.only.engaged) == (True, False)
    assert stopped.disk.content == stopped.rig.base.latch
    assert not stopped.disk.content.engaged
    stopped.rig.drive(0.6)


def test_a_reset_that_cannot_be_written_leaves_the_robot_stopped_for_good(stopped: Office) -> None:
    stopped.disk.trouble = FULL
    asked = stopped.reset()
    stopped.go_on()
    assert (asked.only.done, asked.only.engaged) == (False, True)
    assert FULL in str(asked.only.reason)
    stopped.disk.trouble = ""
    stopped.go_on(5.0)
    assert stopped.rig.base.latch.engaged
    assert stopped.disk.content == stopped.rig.base.latch
    again = stopped.reset()
    stopped.go_on()
    assert again.only.done


def test_a_reset_that_the_disk_is_too_slow_for_is_given_up(stopped: Office) -> None:
    stopped.disk.hangs = True
    asked = stopped.reset()
    stopped.go_on(1.1)
    assert not asked.only.done
    assert "hangs" in str(asked.only.reason)
    assert "hangs" in str(stopped.desk.fault)
    stopped.disk.hangs = False
    stopped.go_on(1.0)
    assert stopped.rig.base.latch.engaged
    assert stopped.disk.content == stopped.rig.base.latch
    assert stopped.desk.fault == NO_TROUBLE


def test_a_reset_that_is_refused_by_the_time_it_is_on_disk_is_answered_so_and_written_back(office: Office) -> None:
    for volts in (19.0, 24.0):
        office.rig.board.battery_adc_counts = round(volts / DRIVE.battery_volts_per_count)
        office.go_on(5.5)
    office.disk.hangs = True
    asked = office.reset()
    office.go_on()
    office.rig.base.on_link_lost(Trouble("unplugged"))
    office.rig.connected = office.disk.hangs = False
    office.go_on()
    assert (asked.only.done, asked.only.engaged) == (False, True)
    assert "not measured now" in str(asked.only.reason)
    office.go_on()
    assert office.disk.content == office.rig.base.latch


def test_a_disk_that_hangs_stops_no_frames_and_is_told_to_who_asked(office: Office) -> None:
    office.rig.drive(0.6)
    office.disk.hangs = True
    asked = office.engage()
    before = len(office.rig.sent)
    office.go_on(3.0)
    frames = office.rig.sent[before:]
    assert len(frames) >= 298
    assert moving(frames) == []
    assert not asked.only.done
    assert "hangs" in str(asked.only.reason)


@pytest.mark.parametrize("order", ["before the disk", "after the disk"])
def test_an_engaging_takes_back_a_reset_that_is_being_written(stopped: Office, order: str) -> None:
    stopped.disk.hangs = True
    reset = stopped.reset()
    stopped.go_on(0.1)
    if order == "after the disk":
        stopped.disk.hangs = False
        stopped.disk.work()
    engage = stopped.engage()
    assert not reset.only.done
    assert "engaged anew" in str(reset.only.reason)
    stopped.disk.hangs = False
    stopped.go_on(0.1)
    assert engage.only.done
    assert stopped.rig.base.latch.engaged
    assert stopped.disk.content == stopped.rig.base.latch


def test_of_two_who_ask_in_one_turn_who_stops_wins(stopped: Office) -> None:
    reset = Asked(EStopReset(by="carer", id=stopped.rig.base.latch.id, tick=stopped.rig.ago(0.1)))
    engage = Asked(EStopEngage(by="keyboard", reason=Trouble("space bar")))
    stopped.desk.on_requests([engage], [reset], stopped.rig.now)
    stopped.go_on(0.1)
    assert not reset.only.done
    assert engage.only.done
    assert stopped.rig.base.latch.engaged


def test_repeated_requests_are_all_answered(office: Office) -> None:
    engages = [office.engage() for _ in range(3)]
    office.go_on()
    assert all(each.only.done for each in engages)
    resets = [office.reset() for _ in range(3)]
    office.go_on()
    assert all(each.only.done for each in resets)
    assert not office.rig.base.latch.engaged
    late = office.reset(age=8.0)
    assert late.only.done  # it is released, as asked; nothing was cleared


def test_a_reset_that_proves_nothing_is_refused_at_once_and_writes_nothing(stopped: Office) -> None:
    writes = stopped.disk.writes
    late = stopped.reset(age=8.0)
    assert not late.only.done
    stopped.go_on(0.1)
    assert stopped.disk.writes == writes


def test_a_reset_ends_the_wait_of_those_who_engaged(office: Office) -> None:
    office.disk.hangs = True
    engage = office.engage()
    office.go_on()
    reset = office.reset()
    assert not engage.only.done
    office.disk.hangs = False
    office.go_on(0.1)
    assert reset.only.done


def test_a_latch_of_the_board_is_kept_too(office: Office) -> None:
    office.rig.drive(0.6)
    office.rig.board.engage(Latch.RIGHT_STUCK)
    office.go_on()
    assert office.disk.content == office.rig.base.latch
    assert "right wheel stuck" in str(office.disk.content.reason)
