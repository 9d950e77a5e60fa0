"""Every stop says why, the first cause first; and what forbids motion forbids arming, too."""

from collections.abc import Callable

import msgspec
import pytest

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import WIRING
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import DriveState, Latch
from tests.support.robots import DRIVE
from tests.unit.base.rig import Rig, moving

UNCHECKED = msgspec.structs.replace(DRIVE, swap_encoders=None)


def engage(rig: Rig) -> None:
    rig.base.on_engage(EStopEngage(by="keyboard", reason=Trouble("space bar")), rig.now)


def lose_link(rig: Rig) -> None:
    rig.base.on_link_lost(Trouble("the port is gone", "plug it in"))
    rig.connected = False


def refuse_configuration(rig: Rig) -> None:
    rig.board.ignores_configure = True
    rig.base.on_link_opened(session=100)


def empty_battery(rig: Rig) -> None:
    rig.board.battery_adc_counts = 600
    rig.run(6.0)


def second_guard(rig: Rig) -> None:
    speaks = rig.guard_speaks
    rig.guard, rig.guard_speaks = "guard-2", True
    rig.run(0.02)
    rig.guard, rig.guard_speaks = "guard-1", speaks


def silence_guard(rig: Rig) -> None:
    rig.guard_speaks = False
    rig.run(0.3)


def stale_operator(rig: Rig) -> None:
    rig.operator_age = 0.5
    rig.run(0.02)


def stale_range(rig: Rig) -> None:
    rig.range_age = 0.5
    rig.run(0.02)


def fault(rig: Rig) -> None:
    rig.source = "fault"
    rig.run(0.02)


def free_lease(rig: Rig) -> None:
    rig.lease_counter = 0
    rig.run(0.02)


def timed_out(rig: Rig) -> None:
    rig.board.is_deaf = True
    rig.board.drive_state, rig.board.levels = DriveState.COMMAND_TIMEOUT, (0, 0)


# From the first to the last: each is named before all that follow it.
CAUSES: list[tuple[Callable[[Rig], None], str]] = [
    (engage, "emergency stop by keyboard"),
    (empty_battery, "emergency stop by battery: the battery is empty"),
    (lose_link, "the port is gone"),
    (refuse_configuration, "being configured"),
    (second_guard, "a second guard, guard-2"),
    (silence_guard, "the guard is not heard"),
    (stale_operator, "no fresh command of an operator"),
    (stale_range, "a range that this motion relies on is too old"),
    (fault, "the operator's side reports a fault"),
    (free_lease, "nobody holds the lease"),
    (timed_out, "in state command_timeout"),
]
PAIRS = [(first, second) for n, first in enumerate(CAUSES) for second in CAUSES[n:]]


@pytest.mark.parametrize(
    ("first", "second"), PAIRS, ids=[f"{first[0].__name__}-{second[0].__name__}" for first, second in PAIRS]
)
def test_of_two_causes_the_first_is_named(
    driven: Rig, first: tuple[Callable[[Rig], None], str], second: tuple[Callable[[Rig], None], str]
) -> None:
    causes = [second[0]] if first is second else [second[0], first[0]]
    for cause in sorted(causes, key=lambda each: each is not empty_battery):  # only a board that works measures it
        cause(driven)
    driven.run(0.02)
    assert first[1] in str(driven.base.state().reason)
    assert not driven.base.state().driving


def test_a_robot_that_is_not_armed_says_so_before_what_the_guard_says(rig: Rig) -> None:
    rig.tilt(0.6)
    rig.reason = "forward blocked"
    rig.run(1.0)
    assert str(rig.base.state().reason) == "not armed since base has just started; hold the hand level for 0.2 s"


@pytest.mark.parametrize("drive", [msgspec.structs.replace(DRIVE, **{name: None}) for name in WIRING])
def test_wiring_that_nobody_has_checked_never_arms(drive: WheelsConfig) -> None:
    rig = Rig(drive=drive)
    rig.run(2.0)
    assert not rig.base.state().armed
    rig.tilt(0.6)
    assert moving(rig.run(2.0)) == []
    assert str(rig.base.state().reason) == "the wiring is not checked; lift the wheels, then run `giraff check wheels`"
    assert str(rig.base.faults["wiring"]) == str(rig.base.state().reason)


def test_unchecked_wiring_is_named_after_the_link() -> None:
    rig = Rig(drive=UNCHECKED)
    rig.run(1.0)
    assert "giraff check wheels" in str(rig.base.state().reason)
    lose_link(rig)
    assert str(rig.base.state().reason) == "the port is gone; plug it in"


def test_a_latch_of_the_board_is_named_before_unchecked_wiring() -> None:
    rig = Rig(drive=UNCHECKED)
    rig.run(0.5)
    rig.board.engage(Latch.LEFT_STUCK)
    rig.run(0.1)
    assert "left wheel stuck" in str(rig.base.state().reason)


def test_driving_is_that_a_wheel_is_asked_to_turn(armed: Rig) -> None:
    armed.tilt(0.003)  # less than half a level
    armed.run(1.0)
    assert armed.sent[-1].levels == (0, 0)
    assert not armed.base.state().driving
    armed.tilt(0.006)
    armed.run(1.0)
    assert armed.base.state().driving


def test_a_rotation_that_relies_on_no_range_passes_while_the_ranger_is_dead(driven: Rig) -> None:
    # Forward and left are asked, the ranger is dead: the guard passes the rotation alone, which relies on no range.
    driven.tilt(0.0, 0.35)
    driven.reason = "forward blocked: no reading; turn"
    sent = driven.run(3.0)
    assert sent[-1].levels == (-10, 10)
    assert sent[-1].state.driving
    assert str(sent[-1].state.reason) == str(driven.reason)
