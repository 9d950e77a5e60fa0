"""`giraff calibrate camera`: pictures, live or of a folder, to the table of a camera in the robot file."""

import sys
from collections.abc import Callable, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Final

from giraff_core.picture.receiver import PictureSource
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera
from giraff_node.config.robot_file import ConfigError
from giraff_node.picture_client import PictureClient
from giraff_setup.camera.board import View, find_board, is_new, missing
from giraff_setup.camera.conclusion import calibrated, changed, in_words
from giraff_setup.camera.guide import read, take_sheets, take_views
from giraff_setup.camera.lens import FEWEST, Lens, LensFit, fit_lens, lens_of
from giraff_setup.camera.picture import Grey, UnusableError
from giraff_setup.camera.sheet import FloorPose, find_sheet, middle_of
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.robot_file import RobotFileError, before_today, document, own_robot_file, record
from giraff_tools.terminal.document import INTERRUPTED, REFUSED, UNUSABLE, Report, complain, no_report, print_report
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, introduce, signals_interrupt
from giraff_tools.terminal.output import DONE
from giraff_tools.terminal.program import user_at_host

_complain: Final = partial(complain, "calibrate camera")
_THEN: Final = "Nothing goes by it yet: copy the file to the robot's other machines, and restart its services at rest."

Measure = Callable[[Human, Lens], tuple[LensFit, list[FloorPose]]]
"""From a person, and the lens of the robot file. Raises UnusableError and NobodyError."""
SHEET: Final = "sheet"
_KINDS: Final = frozenset({".jpg", ".jpeg", ".png"})


def calibrate_camera(
    name: str | None,
    folder: Path | None,
    robot: str | None,
    connect: Sequence[str],
    file: Path | None,
    *,
    as_json: bool = False,
) -> int:
    """Do the whole command; return its exit code. `file`: as of `own_robot_file`.

    `as_json`: the talk goes to standard error.
    """
    return print_report(
        lambda report: _calibrate(name, folder, robot, connect, file, report),
        as_json=as_json,
    )


def _calibrate(
    name: str | None, folder: Path | None, robot: str | None, connect: Sequence[str], file: Path | None, report: Report
) -> int:
    def act(connection: RobotConnection) -> int:
        try:
            path, filed = own_robot_file(connection.robot, file)
            which, camera = choose(filed, name)
            human = Terminal(sys.stdin, sys.stdout)
            introduce(human, connection.robot, path)
            by = f"giraff calibrate, {user_at_host()}"
            with closing(PictureClient(connection.network, connection.robot, which, by)) as pictures:
                return guide(human, which, camera, path, measure_live(pictures), report)
        except (ConfigError, UnusableError) as error:
            return _complain(str(error), UNUSABLE)
        except KeyboardInterrupt:
            return _interrupted()

    with signals_interrupt():
        try:
            if folder is None:
                return run_with_robot(robot, connect, act, stands_in=False)  # it writes into the file
            path, filed = own_robot_file("", file)
            which, camera = choose(filed, name)
            return guide(Terminal(sys.stdin, sys.stdout), which, camera, path, measure_folder(folder), report)
        except (ConfigError, UnusableError) as error:
            return _complain(str(error), UNUSABLE)
        except KeyboardInterrupt:
            return _interrupted()


def choose(filed: RobotConfig, name: str | None) -> tuple[str, Camera]:
    """Return the camera that is meant. Raises UnusableError."""
    cameras = filed.of(Camera)
    if name is None and len(cameras) == 1:
        name = next(iter(cameras))
    if name in cameras:
        return name, cameras[name]
    known = ", ".join(cameras) or "none"
    what = f"has no camera {name}" if name else "has no camera" if not cameras else "has several cameras"
    raise UnusableError(f"the robot file {what}; its cameras: {known}. Name one, or add [robot.sensors.<name>]")


def measure_live(pictures: PictureSource) -> Measure:
    """Return what guides a person before the camera."""

    def measure(human: Human, lens: Lens) -> tuple[LensFit, list[FloorPose]]:
        fit = take_views(human, pictures, lens)
        return fit, take_sheets(human, pictures, fit.lens)

    return measure


def measure_folder(folder: Path) -> Measure:
    """Return what reads a folder of pictures."""

    def measure(human: Human, lens: Lens) -> tuple[LensFit, list[FloorPose]]:
        fit = lens_from(folder, human, lens)
        return fit, poses_from(folder, human, fit.lens)

    return measure


def guide(human: Human, name: str, camera: Camera, path: Path, measure: Measure, report: Report = no_report) -> int:
    """Measure, tell, ask and write; return the exit code."""
    try:
        fit, poses = measure(human, lens_of(camera))
        after = calibrated(camera, fit, middle_of(poses, camera.width))
        human.show(in_words(camera, after, fit, poses))
        if not agrees(human, f"Write into {path}? [yes/no]"):
            return _complain("not wanted. Nothing was written.", REFUSED)
        table, fields = f"robot.sensors.{name}", changed(after)
        kept = record(path, table, fields, kept_as=before_today())
    except UnusableError as error:
        return _complain(f"{error}. Nothing was written.", REFUSED)
    except NobodyError:
        return _complain("nobody answers. Nothing was written.", UNUSABLE)
    except RobotFileError as error:
        return _complain(str(error), REFUSED)
    report(document(path, {table: fields}, kept))
    human.show(f"Written: [{table}] of {path}; as it was before: {kept}. {_THEN}")
    return DONE


def _interrupted() -> int:
    return _complain("interrupted. Nothing was written.", INTERRUPTED)


def lens_from(folder: Path, human: Human, lens: Lens) -> LensFit:
    """Fit the lens to the pictures of the board, and tell which were of no use. Raises UnusableError."""
    views: list[View] = []
    names: list[str] = []
    for path in _pictures(folder):
        if path.name.startswith(SHEET):
            continue
        try:
            view = find_board(_read(path, lens), lens)
        except UnusableError as error:
            human.show(f"{path.name} does not count: {error}.")
            continue
        if is_new(view, views, lens.width):
            views.append(view)
            names.append(path.name)
        else:
            human.show(f"{path.name} does not count: another picture shows the board so already.")
    if (words := missing(views, lens.width, lens.height)) and len(views) >= FEWEST:
        raise UnusableError(f"the {len(views)} views of the board are not spread enough; {words}")
    fit = fit_lens([view.corners for view in views], lens.width, lens.height)
    for number in fit.left_out:
        human.show(f"{names[number]} does not count: its corners do not fit the others'; it may be torn or blurred.")
    return fit


def poses_from(folder: Path, human: Human, lens: Lens) -> list[FloorPose]:
    """Return the pose from each picture of the sheet that tells it."""
    found: list[FloorPose] = []
    for path in _pictures(folder):
        if path.name.startswith(SHEET):
            try:
                found.append(find_sheet(_read(path, lens), lens))
            except UnusableError as error:
                human.show(f"{path.name} does not count: {error}.")
    return found


def _pictures(folder: Path) -> list[Path]:
    try:
        return sorted(path for path in folder.iterdir() if path.suffix.lower() in _KINDS)
    except OSError as error:
        raise UnusableError(f"{folder} cannot be read: {error.strerror}; name a folder of pictures") from error


def _read(path: Path, lens: Lens) -> Grey:
    try:
        return read(path.read_bytes(), lens)
    except OSError as error:
        raise UnusableError(f"it cannot be read: {error.strerror}") from error
