"""A plan in words and for programs, while it grows and in the end."""

import shlex
from collections.abc import Iterator
from textwrap import fill
from typing import TYPE_CHECKING, Any, Final

import msgspec

from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.text import printable
from giraff_schemas.trouble import Trouble
from giraff_setup.map.make.drive import Drive
from giraff_setup.map.make.files import PlanFiles
from giraff_tools.terminal.text import counted

if TYPE_CHECKING:
    from giraff_maps.scan.plan import Figures, MadePlan

_LABEL: Final = 9  # characters
_WIDTH: Final = 70
_WORTH: Final = 0.005  # share by which odometry is off that is worth a word
_INDENT: Final = " " * (_LABEL + 2)
_GOOD: Final = "good; Ctrl-C ends the drive and writes the plan"
_BEGUN: Final = "drive slowly through all rooms, and back to where you began; Ctrl-C then writes the plan"


def now_text(drive: Drive, trouble: Trouble, figures: "Figures | None") -> str:
    """Return how far it is, and what is missing now. `trouble`: why the robot's place is not known."""
    parts = [f"{drive.way:.1f} m driven"]
    if figures is not None:
        parts.append(f"{counted(figures.loops, 'loop')} closed")
    if trouble:
        parts.append(str(trouble) + ("; what was driven is kept" if drive.mapper.keys else ""))
    elif figures is None:
        parts.append(_BEGUN)
    else:
        parts.append(str(figures.missing[0]) if figures.missing else _GOOD)
    return printable(" | ".join(parts))


def report(drive: Drive, plan: "MadePlan", files: PlanFiles, *, offers_wheels: bool = True) -> str:
    """Return what was made, whether it is good, and what to do next.

    `offers_wheels`: it also says how to write what the plan tells of them.
    """
    rows = [row for row in _rows(drive, plan, files) if offers_wheels or row[0] != "wheels"]
    return "\n".join(f"{label:>{_LABEL}}  {text}".replace("\n", f"\n{_INDENT}") for label, text in rows)


def _rows(drive: Drive, plan: "MadePlan", files: PlanFiles) -> Iterator[tuple[str, str]]:
    figures, room = plan.figures, shlex.quote(str(files.toml))
    left, bottom, right, top = FloorPlan("", plan.walls).bounds
    yield "size", f"{right - left:.1f} x {top - bottom:.1f} m, {counted(len(plan.walls), 'straight wall')}"
    others = f"; {' and '.join(sorted(drive.others))} left out" if drive.others else ""
    yield "way", f"{figures.way:.1f} m, {counted(figures.key_turns, 'turn')} of {drive.scanner} kept{others}"
    gap = f", the worst one {figures.loop_gap * 100.0:.1f} cm off" if figures.loops else ""
    yield "loops", f"{figures.loops}{gap}"
    yield "doubles", f"{figures.doubles:.1%} of the walls stand twice"
    scales = drive.mapper.scale, drive.mapper.turn_scale
    if not figures.missing and any(abs(scale - 1.0) > _WORTH for scale in scales):
        way, turns = (f"{abs(1.0 / scale - 1.0):.1%} too {'short' if scale > 1.0 else 'long'}" for scale in scales)
        yield "wheels", f"odometry measures ways {way}, and turns {turns};\n--calibrate corrects the robot file"
    yield "verdict", "\n".join(fill(str(each), _WIDTH) for each in figures.missing) or "good"
    yield "files", "\n".join(map(str, files))
    yield "next", f"giraff map show {room}\ngiraff localize --map {room}"


def document(drive: Drive, plan: "MadePlan", files: PlanFiles) -> dict[str, Any]:
    """Return the same for programs."""
    left, bottom, right, top = FloorPlan("", plan.walls).bounds
    return {
        "scanner": drive.scanner,
        "x": [left, right],
        "y": [bottom, top],
        "walls": len(plan.walls),
        "good": not plan.figures.missing,
        "figures": msgspec.to_builtins(plan.figures),
        "files": {name: str(path) for name, path in files._asdict().items()},
    }
