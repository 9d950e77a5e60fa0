"""The end of a drive: its plan is drawn, written and told."""

import contextlib
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from giraff_maps.scan.plan import MadePlan
from giraff_setup.map.make.drive import Drive
from giraff_setup.map.make.files import write_plan
from giraff_setup.map.make.words import document, report
from giraff_tools.network.command import print_error
from giraff_tools.terminal.progress import Progress
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.text import json_line

DONE: Final = 0
INCOMPLETE: Final = 1


@contextlib.contextmanager
def _giving_up() -> Iterator[list[int]]:
    """Yield a list that each Ctrl-C in the block lengthens. Nothing else ends it: a closed terminal says so twice."""
    asked: list[int] = []
    before = {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGTERM, signal.SIGHUP)}
    before[signal.SIGINT] = signal.signal(signal.SIGINT, lambda number, _: asked.append(number))
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def finish(drive: Drive, stem: Path, *, as_json: bool, is_whole: bool = True) -> int:
    """Return the exit code. `stem`: path of the plan without an ending. `is_whole`: nothing of the drive is missing."""
    if not drive.mapper.keys:
        why = drive.trouble or f"{drive.scanner} sees no walls; drive where they are within its reach"
        return print_error(f"{why}. Nothing was written")
    with _giving_up() as given_up:
        plan = _drawn(drive, given_up)
        if plan is None:
            return print_error("ended by a second Ctrl-C. Nothing was written")
        if not plan.walls:
            return print_error(f"nothing straight was seen on {drive.way:.1f} m. Nothing was written; drive farther")
        try:
            files, elsewhere = write_plan(stem, plan)
        except OSError as error:
            return print_error(
                f"{error.filename or stem}: cannot be written, nor in the home folder or the one for temporary files: "
                f"{error.strerror or error}. Nothing was written"
            )
        if elsewhere:
            print_error(f"{elsewhere}; the plan is {files.toml}")
        say(json_line(document(drive, plan, files)) if as_json else report(drive, plan, files))
    return INCOMPLETE if plan.figures.missing or not is_whole else DONE


def _drawn(drive: Drive, given_up: list[int]) -> MadePlan | None:
    """Return the plan. None: it was given up."""
    with Progress("drawing the plan; Ctrl-C gives it up") as progress:
        for part in drive.plan():
            if given_up:
                return None
            if isinstance(part, MadePlan):
                return part
            progress.move(part)
    return None
