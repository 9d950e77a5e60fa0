"""Runs with a part for each: one room, one hand, and faults at given moments."""

from random import Random
from typing import Final

from giraff_sim.config import SimConfig
from giraff_sim.dst.simulated_run import SIM, Begin, Kind, Outcome, Scenario, ScheduledFault, known_settings, play
from giraff_sim.settings import Services, Settings
from giraff_sim.truth import EXACT, Truth
from giraff_sim.world.hand import LEVEL, Hand, ScriptedHand, StillHand
from giraff_sim.world.room import Pose, Room

SETTINGS: Final = known_settings()
FORWARD: Final = (4.0, 0.0, 8.96)
"""m/s² on the joystick: 24 degrees."""
BACKWARD: Final = (-4.0, 0.0, 8.96)
LEFT: Final = (0.0, 4.0, 8.96)
SET_OFF: Final = 1.5
"""s at which `driving` tilts the joystick. The robot is armed 1.3 s after its power-on."""


def hall(start: float = 1.0) -> Room:
    """Four walls, the one ahead 5 m - `start` away: near enough to echo."""
    room = Room("hall", Pose(start, 2.0, 0.0))
    room.add_wall("walls", [(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 4.0)], closed=True)
    return room


def driving(*changes: tuple[float, tuple[float, float, float]]) -> Hand:
    """Level, then forward, then as `changes` tell: (s, m/s²)."""
    moments = [(0.0, LEVEL), (SET_OFF, FORWARD), *changes]
    return ScriptedHand([at for at, _ in moments], [tilt for _, tilt in moments])


def level() -> Hand:
    return StillHand()


def at(moment: float, begin: Begin, lasts: float = 0.0) -> ScheduledFault:
    """Have `begin` happen at `moment`, for `lasts`, s."""
    return ScheduledFault(Kind("staged", begin, 1.0, (lasts, lasts), 3.0), moment, Random(1))


def stage(
    *faults: ScheduledFault,
    hand: Hand | None = None,
    seconds: float = 6.0,
    services: Services | None = None,
    room: Room | None = None,
    seed: int = 1,
    presses: tuple[tuple[float, float], ...] = (),
    settings: Settings = SETTINGS,
    sim: SimConfig = SIM,
    truth: Truth = EXACT,
    until: str = "",
) -> Outcome:
    """`presses`: when the joystick's button is pressed and let go, s. `until`: rules; it ends once all are violated."""
    scenario = Scenario(seed, room or hall(), hand or driving(), seconds, faults, truth, presses)
    return play(scenario, settings, services, sim=sim, until_rules=until)


def rules(outcome: Outcome) -> set[str]:
    """The letters of what it violates."""
    return {violation.rule for violation in outcome.violations}
