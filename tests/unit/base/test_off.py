"""Off in base's emergency stop: asked for by its own word, kept on disk, and ended by a reset alone."""

import msgspec
import pytest

from giraff_base.drives.wheels.drive import WheelsDrive
from giraff_base.estop import EStopControl, EStopLatch
from giraff_core.estop.latch import latch_bytes
from giraff_schemas.messages import RobotTime
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import Trouble
from tests.unit.base.rig import EPOCH, Rig
from tests.unit.base.test_estop import ENGAGED, engage, reset


def asked_of_a_drive_that_knows_off(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Make the rig's drive know off, and return what `hold` is told."""
    told: list[bool] = []
    monkeypatch.setattr(WheelsDrive, "can_power_off", True)
    monkeypatch.setattr(WheelsDrive, "hold", lambda _, *, off: told.append(off))
    return told


def test_off_is_asked_for_by_its_own_word_and_ended_by_a_reset_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    held = asked_of_a_drive_that_knows_off(monkeypatch)
    rig = Rig()
    for person in ("anna", "ben", "cleo", "ben", "anna"):
        engage(rig, person)
    for _ in range(50):
        engage(rig)
    assert not rig.base.estop().off, "a second STOP is only a second STOP"
    stopped = rig.base.latch
    rig.base.on_engage(EStopEngage(by=stopped.by, reason=stopped.reason, off=True), rig.now)
    assert rig.base.estop().off
    assert rig.base.latch.id != stopped.id, "a reset of the stop before leaves it"
    engage(rig)
    assert rig.base.estop().off, "a plain stop does not end it"
    again = Rig(latch=msgspec.json.decode(latch_bytes(rig.base.latch), type=EStopLatch))
    assert again.base.estop().off, "it is kept on disk"
    assert held == [False] * 55 + [True] * 3
    assert reset(rig).done
    assert not rig.base.estop().off
    engage(rig)
    assert not rig.base.estop().off


@pytest.mark.parametrize("can_power_off", [True, False])
def test_a_board_that_switches_off_under_an_engaged_stop_turns_it_into_off(can_power_off: bool) -> None:
    control = EStopControl(ENGAGED, 1.0, can_power_off=can_power_off)
    cord = EStopEngage(by="base board", reason=Trouble("the cord was pulled"), off=True)
    assert control.is_news(cord) == can_power_off
    assert not control.is_news(msgspec.structs.replace(cord, off=False))
    control.engage(cord, RobotTime(epoch=EPOCH, robot_ns=1))
    assert control.latch.off == can_power_off
    assert not control.is_news(cord)


def test_a_drive_without_off_takes_it_as_a_plain_stop() -> None:
    rig = Rig(latch=msgspec.structs.replace(ENGAGED, off=True))
    assert (rig.base.latch.engaged, rig.base.latch.off) == (True, False)
    rig.base.on_engage(EStopEngage(by="keyboard", reason=Trouble("space bar held"), off=True), rig.now)
    assert (rig.base.latch.engaged, rig.base.latch.off) == (True, False)
