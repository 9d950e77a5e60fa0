"""Why the robot does not drive: what was heard, made into the chain from hand to wheel and its first broken link."""

from __future__ import annotations

from typing import Final

import msgspec

from giraff_cli.why import checks as links
from giraff_cli.why.chain import ChainState, Link
from giraff_cli.why.observation import Observation
from giraff_schemas.topics import CAMERA_STATE
from giraff_telemetry.describe import seen_text
from giraff_tools.network.versions import version_trouble

LINKS: Final = ("hand", "operator", "lease", "ranger", "guard", "base", "e-stop", "board", "wheels")
"""From hand to wheel, as they are told."""

_JUDGES: Final = {
    "operator": links.operator,
    "hand": links.hand,
    "e-stop": links.estop,
    "ranger": links.ranger,
    "guard": links.guard,
    "board": links.board,
    "lease": links.lease,
    "base": links.base,
    "wheels": links.wheels,
}
"""In the order in which they are judged: a link that only suffers from another one waits for it and is not to blame."""


class Diagnosis(msgspec.Struct, frozen=True, kw_only=True):
    """The answer to `giraff why`."""

    robot: str
    drives: bool
    """It moves now."""
    stopped_by: str
    """The first link that stops it; empty: none does."""
    conclusion: str
    """What that is, and what to do."""
    links: tuple[Link, ...]
    cameras: tuple[str, ...] = ()
    """Who sees what the robot's cameras see, a line each that is on. It stops nothing."""
    versions: str = ""
    """Which versions run where; empty: all are the one of this command. Hosts of two formats do not hear each other."""


def diagnose(observation: Observation) -> Diagnosis:
    """The chain, and what to do."""
    state = ChainState(observation)
    for name, judge in _JUDGES.items():
        state.links[name] = judge(state)
    chain = tuple(state.links[name] for name in LINKS)
    broken = [link for link in chain if link.breaks]
    drives = state.base is not None and state.base.sample.driving
    return Diagnosis(
        robot=observation.robot,
        drives=drives,
        stopped_by=broken[0].name if broken else "",
        conclusion=_conclude(chain, broken, drives),
        links=chain,
        versions=str(version_trouble(observation.host, observation.version, observation.health)),
        cameras=tuple(text for seen in observation.of(CAMERA_STATE) if (text := seen_text(seen.sample))),
    )


def _conclude(chain: tuple[Link, ...], broken: list[Link], drives: bool) -> str:
    if broken:
        first, *others = broken
        return f"{first.name}: {first.text}" + (f" (then: {', '.join(link.name for link in others)})" if others else "")
    if idle := next((link for link in chain if link.status == "idle"), None):
        operator = next(link for link in chain if link.name == "operator")
        return f"{idle.text}; {operator.text}" if operator.status == "limits" else idle.text
    limits = "; ".join(f"{link.name}: {link.text}" for link in chain if link.status == "limits")
    if drives:
        return "the robot drives" + (f", but {limits}" if limits else "")
    return "nothing stops the robot" + (f", but {limits}" if limits else ": it drives when the hand asks for it")
