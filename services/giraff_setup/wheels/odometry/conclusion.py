"""From measured runs to the robot file: fitted, judged, told and written, or refused and nothing written."""

import datetime as dt
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from giraff_setup.wheels.odometry.fit import UndeterminedError, fit
from giraff_setup.wheels.odometry.judgement import (
    for_programs,
    in_words,
    is_known_already,
    judge,
    table_of,
    too_large_a_change,
)
from giraff_setup.wheels.odometry.runs import Geometry, Run
from giraff_tools.robot_file import RobotFileError, record
from giraff_tools.terminal.document import REFUSED, complain
from giraff_tools.terminal.output import DONE
from giraff_tools.terminal.page import print_wrapped

refuse: Final = partial(complain, "calibrate odometry")
_NOT_WRITTEN: Final = "Nothing was written"


class Conclusion(NamedTuple):
    """What came of it."""

    code: int
    """Exit code of the command."""
    outcome: dict[str, Any]
    """For programs; empty: there was nothing to judge. Its robot_file is where it was written into, or None."""


def conclude(
    fitted: Sequence[Run],
    checked: Sequence[Run],
    geometry: Geometry,
    robot_file: Path | None,
    *,
    force: bool,
    tell: Callable[[str], None] = print_wrapped,
    agrees: Callable[[], bool] = lambda: True,
    then: str = "Nothing goes by it before the robot's services are restarted, at rest.",
) -> Conclusion:
    """Fit, judge and write into `robot_file`; None: into none.

    `force`: a scale far from the one before is taken, too. `agrees`: asked once all is told, before anything is
    written. `then`: what is to be done once it is.
    """
    if not checked:
        return Conclusion(refuse(f"no run is left to judge the fit by: add one. {_NOT_WRITTEN}.", REFUSED), {})
    try:
        found = fit(fitted, geometry)
    except UndeterminedError as error:
        return Conclusion(refuse(f"{error}. {_NOT_WRITTEN}.", REFUSED), {})
    judgement = judge(checked, geometry, found.scales)
    tell(in_words(found, judgement, geometry))
    is_known = is_known_already(found, geometry.scales)
    refusal = (
        "" if is_known else judgement.refusal or ("" if force else too_large_a_change(geometry.scales, found.scales))
    )
    outcome = {**for_programs(found, judgement, geometry), "refused": refusal, "robot_file": None}
    if refusal:
        return Conclusion(refuse(f"refused: {refusal}. {_NOT_WRITTEN}.", REFUSED), outcome)
    if robot_file is None:
        tell(f"{_NOT_WRITTEN}: the robot file is that of another robot.")
        return Conclusion(DONE, outcome)
    if is_known:
        tell(f"Nothing to gain: it is calibrated so already. {_NOT_WRITTEN}.")
        return Conclusion(DONE, outcome)
    if not agrees():
        return Conclusion(refuse(f"not wanted. {_NOT_WRITTEN}.", REFUSED), outcome)
    table = table_of(found, judgement, dt.datetime.now().astimezone().date().isoformat())
    try:
        kept = record(robot_file, "robot.calibration", msgspec.to_builtins(table), kept_as=f"before-{table.date}")
    except RobotFileError as error:
        return Conclusion(refuse(str(error), REFUSED), outcome)
    tell(f"Written: [robot.calibration] of {robot_file}; as it was before: {kept}. {then}")
    return Conclusion(DONE, {**outcome, "robot_file": str(robot_file)})
