"""The end of a drive: its plan is drawn, written and told."""

import signal
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final, Self

from giraff_setup.map.make.drive import Drive
from giraff_setup.map.make.files import write_plan
from giraff_setup.map.make.words import document, report
from giraff_tools.network.command import print_error
from giraff_tools.terminal.progress import Progress
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.text import json_line

if TYPE_CHECKING:
    from giraff_maps.scan.plan import MadePlan

DONE: Final = 0
INCOMPLETE: Final = 1
_LATE: Final = (signal.SIGTERM, signal.SIGHUP)
"""They end the drive. The plan is written all the same."""


class GivingUp:
    """In its block Ctrl-C gives the plan up, and nothing else does."""

    def __init__(self) -> None:
        self.asked = False
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Self:
        self._before = {number: signal.signal(number, signal.SIG_IGN) for number in _LATE}
        self._before[signal.SIGINT] = signal.signal(signal.SIGINT, self._on_signal)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, *_: object) -> None:
        self.asked = True


def finish(drive: Drive, stem: Path, *, as_json: bool, is_whole: bool = True) -> int:
    """Return the exit code. `stem`: path of the plan without an ending. `is_whole`: nothing of the drive is missing."""
    if not drive.mapper.keys:
        return print_error(f"{drive.trouble}. Nothing was written")
    with GivingUp() as giving_up:
        plan = _drawn(drive, giving_up)
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


def _drawn(drive: Drive, giving_up: GivingUp) -> "MadePlan | None":
    """Return the plan. None: it was given up."""
    with Progress("drawing the plan; Ctrl-C gives it up") as progress:
        for part in drive.plan():
            if giving_up.asked:
                return None
            if not isinstance(part, float):
                return part
            progress.move(part)
    return None
