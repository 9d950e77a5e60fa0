"""Rows of the fault table in simulated time: with the hand as it was, PWM is zero within the bound."""

from typing import Final, NamedTuple

import pytest

from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.config import SimConfig
from giraff_sim.dst.simulated_run import SIM, Begin, ScheduledFault
from giraff_sim.record import MotorWindow
from giraff_sim.settings import Settings
from giraff_sim.world.bno055 import Bno055Fault, Vector
from giraff_sim.world.hand import LEVEL, ScriptedHand
from giraff_sim.world.sonar import SonarFault
from tests.dst.courses import (
    HAND,
    block_wheel,
    brake_wheel,
    cut_both_ways,
    cut_encoder,
    delay,
    discharge,
    end,
    engage,
    fail_sonar,
    fail_tilt_sensor,
    flooding,
    kill,
    pause,
    reset_of,
    unplug,
    watch,
)
from tests.dst.stage import BACKWARD, FORWARD, SET_OFF, SETTINGS, at, hall, stage

LEFT: Final[Vector] = (0.0, 4.0, 8.96)
FAULT: Final = 1.9
"""s; the robot drives for a third of a second by then."""
WATCHED: Final = 0.3
"""s after the bound; test_doubles watches for what moves by itself later on."""


class Row(NamedTuple):
    """What faults, each thing so many s after the first one, and within what time all is still."""

    bound: float
    faults: tuple[Begin, ...]
    tilt: Vector = FORWARD
    apart: float = 0.0
    reason: str = ""
    """Among what is counted."""


def _sonars(fault: SonarFault, bound: float) -> dict[str, Row]:
    tilts = FORWARD, FORWARD, BACKWARD
    return {f"sonar {index} {fault}": Row(bound, (fail_sonar(index, fault),), tilt) for index, tilt in enumerate(tilts)}


_BASE_RESET: Final = reset_of(BoardKind.BASE, ResetCause.EXTERNAL)
_JOYSTICK_RESET: Final = reset_of(BoardKind.JOYSTICK, ResetCause.EXTERNAL)
_SIDES: Final = {"base": 0.35, "guard": 0.35, "joystick": 0.45, "ranger": 0.45}

ROWS: Final = {
    **{f"{service} ended": Row(bound, (end(service),)) for service, bound in _SIDES.items()},
    **{f"{service} suspended": Row(bound, (pause(service),)) for service, bound in _SIDES.items()},
    "base suspended": Row(0.35, (pause("base"),), reason="stop: the guard's command is too old"),
    "link cut": Row(0.45, (cut_both_ways,)),
    "link delayed by 0.5 s": Row(0.45, (delay(0.5),)),
    "joystick board unplugged": Row(0.45, (unplug("joystick"),)),
    "base board reset (external)": Row(0.35, (_BASE_RESET,)),
    "joystick board reset (external)": Row(0.45, (_JOYSTICK_RESET,)),
    **_sonars(SonarFault.DEAD, 0.45),
    **_sonars(SonarFault.STUCK, 0.45),
    **_sonars(SonarFault.FROZEN, 1.5),
    "tilt sensor zero": Row(0.45, (fail_tilt_sensor(Bno055Fault.ZERO),)),
    "tilt sensor system_error": Row(0.45, (fail_tilt_sensor(Bno055Fault.SYSTEM_ERROR),)),
    "tilt sensor wrong_chip + joystick board reset (external)": Row(
        0.45, (fail_tilt_sensor(Bno055Fault.WRONG_CHIP), _JOYSTICK_RESET)
    ),
    "tilt sensor self_test + joystick board reset (external)": Row(
        0.45, (fail_tilt_sensor(Bno055Fault.SELF_TEST), _JOYSTICK_RESET)
    ),
    "left encoder cut": Row(0.35, (cut_encoder(0),)),
    "right encoder cut": Row(0.35, (cut_encoder(1),)),
    "left wheel blocked": Row(0.35, (block_wheel(0),)),
    "right wheel blocked": Row(0.35, (block_wheel(1),)),
    "left wheel held back": Row(0.35, (brake_wheel(0, HAND),)),
    "right wheel held back": Row(0.35, (brake_wheel(1, HAND),)),
    "battery at 18 V": Row(5.5, (discharge(18.0),), LEFT),
    "e-stop engaged": Row(0.35, (engage,)),
    "e-stop engaged + base killed": Row(0.35, (engage, kill("base")), apart=0.05),
    "e-stop engaged + base board reset (power_on)": Row(
        0.35, (engage, reset_of(BoardKind.BASE, ResetCause.POWER_ON)), apart=0.05
    ),
    "joystick killed + ranger killed": Row(0.55, (kill("joystick"), kill("ranger"))),
    "guard killed + base killed": Row(0.55, (kill("guard"), kill("base"))),
    "guard suspended + joystick board unplugged": Row(0.55, (pause("guard"), unplug("joystick"))),
    "link cut + base board unplugged": Row(0.55, (cut_both_ways, unplug("base"))),
    "link cut + ranger suspended": Row(0.55, (cut_both_ways, pause("ranger"))),
    "base board reset (external) + guard killed": Row(0.55, (_BASE_RESET, kill("guard"))),
}
"""By the names of docs/safety.md."""


def driven_ms(
    row: Row,
    *others: ScheduledFault,
    settings: Settings = SETTINGS,
    sim: SimConfig = SIM,
) -> float:
    """Once the bound has passed, of a robot that drove until the fault."""
    before: list[MotorWindow] = []
    after: list[MotorWindow] = []
    outcome = stage(
        at(FAULT - 0.1, watch(before), 0.1),
        *(at(FAULT + row.apart * place, fault, row.bound + WATCHED) for place, fault in enumerate(row.faults)),
        at(FAULT + row.bound, watch(after), WATCHED),
        *others,
        settings=settings,
        sim=sim,
        hand=ScriptedHand([0.0, SET_OFF], [LEVEL, row.tilt]),
        room=hall(4.0 if row.tilt == BACKWARD else 1.0),
        seconds=FAULT + row.bound + WATCHED + 0.02,
    )
    assert outcome.violations == ()
    assert row.reason in ("", *outcome.counts)
    assert before[0].driven_ms > 90, "it did not drive before"
    return after[0].driven_ms


@pytest.mark.parametrize("name", ROWS)
def test_a_fault_stops_the_robot_within_its_bound(name: str) -> None:
    assert driven_ms(ROWS[name]) == 0


def test_a_flood_of_a_stranger_changes_no_bound() -> None:
    assert driven_ms(ROWS["joystick suspended"], at(SET_OFF, flooding, 20.0)) == 0


@pytest.mark.parametrize(("bound", "tilt"), [(1.5, FORWARD), (1.5, BACKWARD), (5.5, LEFT)], ids=str)
def test_without_a_fault_it_drives_on(bound: float, tilt: Vector) -> None:
    assert driven_ms(Row(bound, (), tilt)) > 900 * WATCHED


def test_a_wheel_that_is_held_three_times_within_a_minute_engages_the_emergency_stop() -> None:
    """Each time its operator has held the hand level and tilted it again; after the third that moves nothing."""
    tilts = [moment for start in (SET_OFF, 4.0, 6.5, 9.0) for moment in ((start - 1.0, LEVEL), (start, FORWARD))]
    after: list[MotorWindow] = []
    outcome = stage(
        *(at(moment, brake_wheel(1, HAND), 0.3) for moment in (2.5, 5.0, 7.5)),
        at(8.0, watch(after), 3.0),
        hand=ScriptedHand([0.0, *(moment for moment, _ in tilts)], [LEVEL, *(tilt for _, tilt in tilts)]),
        seconds=11.1,
    )
    assert outcome.violations == ()
    assert outcome.counts["stop: not armed since the right wheel was held"] == 2
    assert sum(what.startswith("stop: emergency stop by the base board") for what in outcome.counts) == 1
    assert after[0].driven_ms == 0
