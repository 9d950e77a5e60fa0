"""`giraff calibrate odometry --fit … --check …`: from runs that were recorded with their true poses."""

import glob
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load, robot_file
from giraff_setup.wheels.odometry.conclusion import conclude, refuse
from giraff_setup.wheels.odometry.recorded.slips import require_plausible
from giraff_setup.wheels.odometry.recorded.tables import RecordingError, as_run, read_metadata, read_table
from giraff_setup.wheels.odometry.runs import Geometry, Run
from giraff_tools.terminal.document import UNUSABLE, Report, print_report
from giraff_tools.terminal.program import redirected


class CommandLine(NamedTuple):
    """The command line. `fitted` and `checked` have files, patterns, or several with commas between."""

    fitted: Sequence[str]
    checked: Sequence[str]
    more: Sequence[str]
    """What belongs to no option."""
    metadata: Path | None
    """None: the runs are those of the robot of the robot file, which is told what was found."""
    file: Path | None
    """The robot file; None: this machine's."""
    force: bool
    is_live: bool
    """A robot on the network was asked for, too."""


def calibrate_recorded(asked: CommandLine, *, as_json: bool) -> int:
    """Do the whole command; return its exit code. `as_json`: the outcome is printed, and the rest told beside it."""
    return print_report(lambda report: _calibrate(asked, report), as_json=as_json)


def _calibrate(asked: CommandLine, report: Report) -> int:
    try:
        _require_sense(asked)
        fit_files, check_files = files_of("--fit", asked.fitted), files_of("--check", asked.checked)
        path, geometry = (None, read_metadata(asked.metadata)) if asked.metadata is not None else _own(asked.file)
        runs = read_runs([*fit_files, *check_files], geometry)
        to_fit, to_check = runs[: len(fit_files)], runs[len(fit_files) :]
    except (RecordingError, ConfigError) as error:
        return refuse(str(error), UNUSABLE)
    conclusion = conclude(to_fit, to_check, geometry, path, force=asked.force)
    if conclusion.outcome:
        report(conclusion.outcome)
    return conclusion.code


def _require_sense(asked: CommandLine) -> None:
    if form := redirected(asked.more):
        raise RecordingError(form)
    if asked.more:
        raise RecordingError(
            f"{asked.more[0]} belongs to no option; put a pattern in quotes, like --fit 'a*.csv', or give --fit or "
            "--check for each file"
        )
    if asked.file and asked.metadata:
        raise RecordingError("--metadata is of another robot, whose robot file is not written; leave --file out")
    if asked.is_live:
        raise RecordingError("--robot and --connect are for a live robot; leave them out with recorded runs")


def files_of(option: str, words: Sequence[str]) -> list[Path]:
    """The files that an option's words name, in the order of the words. RecordingError where one names none."""
    files: list[Path] = []
    for word in words:
        for part in [word] if Path(word).exists() else word.split(","):
            if any(character in part for character in "*?[") and not Path(part).exists():
                matching = sorted(glob.glob(part, recursive=True))  # noqa: PTH207  a pattern may begin anywhere
                if not matching:
                    raise RecordingError(f"{option} {part}: no file is called like that; check the folder you are in")
                files += map(Path, matching)
            elif part:
                files.append(Path(part))
    if not files:
        what = "runs that the fit does not see" if option == "--check" else "runs to fit to"
        raise RecordingError(f"{option} names no file; give {option} FILE with {what}, once for each or with commas")
    return files


def read_runs(files: Sequence[Path], geometry: Geometry) -> list[Run]:
    """One for each file; RecordingError where it is none of this robot's, or there twice."""
    runs: list[Run] = []
    seen: dict[bytes, Path] = {}
    for file in files:
        table = read_table(file)
        require_plausible(str(file), table, geometry)
        twin = seen.setdefault(table.tobytes(), file)
        if twin is not file:
            other = "is there twice" if twin == file else f"is the same run as {twin}"
            raise RecordingError(f"{file}: {other}; a run is fitted or checked, and once")
        runs.append(as_run(str(file), table))
    return runs


def _own(file: Path | None) -> tuple[Path, Geometry]:
    """Of the robot file."""
    environment = os.environ if file is None else {**os.environ, "GIRAFF_CONFIG": str(file)}
    robot = load("robot", RobotConfig, environment)
    return robot_file(environment), Geometry(robot.ticks_per_metre, robot.track_width, robot.calibration.scales)
