"""Faults of the network between the operator's machine and the robot's."""

from random import Random
from typing import Final

from giraff_schemas.messages import DriveCommand, GuardedCommand, Lease, Range, Tick, Wheels
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_sim.dst.judging.stops import BEYOND_US
from giraff_sim.dst.network import Link
from giraff_sim.dst.simulated_run import Course, Kind, SimulatedRun, fault

KINDS: Final[list[Kind]] = []

_REPLAYED: Final = (
    (DriveCommand,),
    (DriveCommand, Lease, Tick),
    (GuardedCommand,),
    (Range,),
    (Tick,),
    (Wheels, Range),
    (EStopReset, EStopAnswer),
    (EStopEngage,),
)


def _ways(run: SimulatedRun, chance: Random) -> tuple[str, list[Link]]:
    """One way or both, and their links."""
    name = chance.choice(("both ways", "to the robot", "from the robot"))
    to, back = run.link("operator", "robot"), run.link("robot", "operator")
    return name, {"both ways": [to, back], "to the robot": [to], "from the robot": [back]}[name]


@fault(KINDS, weight=2.0, lasts=(0.3, 4.0))
def delay(run: SimulatedRun, chance: Random) -> Course:
    name, links = _ways(run, chance)
    if not run.claims("delay"):
        return
    before = [(link.delay_us, link.jitter_us) for link in links]
    delay_us, jitter_us = chance.randint(20_000, 300_000), chance.choice((0, chance.randint(0, 100_000)))
    for link in links:
        link.delay_us, link.jitter_us = delay_us, jitter_us
    yield f"the network takes {delay_us / 1000:.0f} to {(delay_us + jitter_us) / 1000:.0f} ms {name}"
    for link, (delay_us, jitter_us) in zip(links, before, strict=True):
        link.delay_us, link.jitter_us = delay_us, jitter_us


@fault(KINDS, weight=1.5, lasts=(0.3, 4.0))
def loss(run: SimulatedRun, chance: Random) -> Course:
    name, links = _ways(run, chance)
    if not run.claims("loss"):
        return
    share = chance.uniform(0.05, 0.8)
    for link in links:
        link.loss = share
    yield f"the network loses {share:.0%} {name}"
    for link in links:
        link.loss = 0.0


@fault(KINDS, weight=1.0, lasts=(0.5, 4.0))
def disorder(run: SimulatedRun, chance: Random) -> Course:
    name, links = _ways(run, chance)
    if not run.claims("disorder"):
        return
    overtakes, duplicates = chance.uniform(0.0, 0.5), chance.uniform(0.0, 0.5)
    for link in links:
        link.overtakes, link.duplicates = overtakes, duplicates
    yield f"of what is said {name} {overtakes:.0%} is overtaken and {duplicates:.0%} comes twice"
    for link in links:
        link.overtakes = link.duplicates = 0.0


@fault(KINDS, weight=4.0, lasts=(0.05, 4.0))
def cut(run: SimulatedRun, chance: Random) -> Course:
    name, links = _ways(run, chance)
    if not run.claims("cut"):
        return
    how = chance.choice(("loses", "holds"))
    for link in links:
        link.cut = how
    with run.stops("the network is cut", BEYOND_US, applies=lambda: run.drives("operator")):
        yield f"the network is cut {name}; TCP {how} what is said"
    for link in links:
        run.network.mend(link)


@fault(KINDS, weight=4.0, lasts=(0.0, 0.5))
def replay(run: SimulatedRun, chance: Random) -> Course:
    kinds = chance.choice(_REPLAYED)
    now_us = run.loop.agenda.now_us
    until_us = now_us - round(chance.uniform(0.2, 1.0) * min(8_000_000, now_us))
    from_us = until_us - chance.randint(100_000, 3_000_000)
    old = [said for said in run.network.history if from_us <= said.at_us <= until_us and type(said.body) in kinds]
    spread_us = chance.choice((20_000, 500_000, until_us - from_us))
    run.network.replay(old, spread_us)
    names = ", ".join(kind.__name__ for kind in kinds)
    yield (
        f"{len(old)} old samples ({names}) come again, {(now_us - until_us) / 1e6:.2f} to "
        f"{(now_us - from_us) / 1e6:.2f} s old, within {spread_us / 1e6:.2f} s"
    )
    if EStopEngage in kinds and old:
        run.release_later()
