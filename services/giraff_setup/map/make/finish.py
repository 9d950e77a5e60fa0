"""The end of a drive: its plan is drawn, written and told."""

import contextlib
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from giraff_maps.floor_plan import FloorPlan
from giraff_maps.scan.plan import MadePlan
from giraff_maps.scan.redraw import placed_on, redrawn
from giraff_setup.map.make.drive import Drive
from giraff_setup.map.make.files import PlanFiles, plan_of, rewrite_plan, stem_of, write_plan
from giraff_setup.map.make.wheels import calibrated
from giraff_setup.map.make.words import document, report
from giraff_tools.network.command import print_error
from giraff_tools.robot_file import own_robot_file
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


class Wish(NamedTuple):
    """The command line of the plan."""

    stem: Path
    """Path of the plan, without an ending."""
    old: FloorPlan | None
    """Plan of that name, which is redrawn. None: a new one is made."""
    calibrate: bool
    """The robot file is told wheels and track."""
    file: Path | None = None
    """The robot file, as of `own_robot_file`."""

    def require_robot_file(self, robot: str) -> None:
        """Raise ConfigError where the robot file cannot be told, before anything is driven."""
        if self.calibrate:
            own_robot_file(robot, self.file)


def wish_of(name: Path, *, onto: bool, calibrate: bool, file: Path | None) -> Wish:
    """Return what is asked for. Raises MapError where there is no such plan, or one that is not to be redrawn."""
    stem, old = plan_of(name) if onto else (stem_of(name), None)
    return Wish(stem, old, calibrate, file)


def finish(drive: Drive, robot: str, wish: Wish, *, as_json: bool, is_whole: bool = True) -> int:
    """Return the exit code. `is_whole`: nothing of the drive is missing."""
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
            plan, files, elsewhere = _written(drive, wish, plan)
        except OSError as error:
            return print_error(
                f"{error.filename or wish.stem}: cannot be written, nor in the home folder or the one for temporary "
                f"files: {error.strerror or error}. Nothing was written"
            )
        if elsewhere:
            print_error(f"{elsewhere}; the plan is {files.toml}")
        told = report(drive, plan, files, offers_wheels=not wish.calibrate)
        say(json_line(document(drive, plan, files)) if as_json else told)
    code = DONE if is_whole and not (plan.figures.missing or elsewhere) else INCOMPLETE
    return (calibrated(drive, robot, wish.file, plan.figures) and INCOMPLETE) or code if wish.calibrate else code


def _written(drive: Drive, wish: Wish, plan: MadePlan) -> tuple[MadePlan, PlanFiles, str]:
    """Return the plan as it was written, its files, and why these are not those that were asked for."""
    if wish.old is None:
        return plan, *write_plan(wish.stem, plan)
    try:
        *_, again = drive.plan(placed_on(wish.old, plan))
        assert isinstance(again, MadePlan)  # noqa: S101  the last part
        both = redrawn(wish.old, again)
        return both, rewrite_plan(wish.stem, both), ""
    except Exception as error:  # noqa: BLE001  whatever it is, the drive is not lost
        files, _ = write_plan(wish.stem, plan)
        return plan, files, f"{wish.stem} stays as it was: {getattr(error, 'strerror', None) or error}"


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
