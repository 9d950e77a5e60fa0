"""The verbs of `giraff calibrate`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot, WrittenFile, require_extra

calibrate = typer.Typer(no_args_is_help=True, help="What a robot truly is, measured and written into the robot file.")

_RUNS = "CSV: time s, x m, y m, heading rad (truth), right counts, left counts since the row before; no header."


@calibrate.callback()
def about() -> None:
    """What a robot truly is, measured and written into the robot file."""


@calibrate.command()
def odometry(  # noqa: PLR0913, PLR0917  one argument an option
    more: Annotated[list[str] | None, typer.Argument(hidden=True)] = None,
    fit: Annotated[
        list[str] | None,
        typer.Option(metavar="RUNS", help=f"Recorded runs to fit to: FILE,FILE, 'PATTERN*', or --fit again. {_RUNS}"),
    ] = None,
    check: Annotated[
        list[str] | None,
        typer.Option(metavar="RUNS", help="Recorded runs that judge the fit, which does not see them."),
    ] = None,
    metadata: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Of recorded runs of another robot (rows ngear, encRes, Li, Di): the robot file is neither read nor "
            "written. Without it they are this robot's, and the robot file is.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Take a wheel that is 5 %, a track that is 10 % other than before.")
    ] = False,
    file: WrittenFile = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Measure wheels and track: drive lines, turns and squares by what this says; or --fit and --check recorded runs.

    Checked runs that end farther off on average than before refuse it, also with --force. Of the robot file only
    the table robot.calibration changes; a copy of it as it was stays beside it.

    Exit code: 0 done, or nothing to gain; 1 refused, nothing written; 2 not begun.
    """
    require_extra("calibrate odometry", "numpy", "analysis,cli")
    if not (fit or check or metadata or more):
        from giraff_setup.wheels.odometry.calibrate import calibrate_odometry  # noqa: PLC0415

        raise typer.Exit(calibrate_odometry(robot, connect or (), file, force=force, as_json=as_json))
    from giraff_setup.wheels.odometry.recorded.calibrate import CommandLine, calibrate_recorded  # noqa: PLC0415

    asked = CommandLine(fit or (), check or (), more or (), metadata, file, force, is_live=bool(robot or connect))
    raise typer.Exit(calibrate_recorded(asked, as_json=as_json))


@calibrate.command()
def camera(
    which: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="Of the camera; else the only one.", show_default=False)
    ] = None,
    pictures: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Pictures that were taken before: sheet*.jpg show the sheet, all other *.jpg and *.png the board.",
            show_default=False,
        ),
    ] = None,
    file: WrittenFile = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Measure a camera: its lens by the board of `giraff camera board`, height and tilt by a sheet of A4 on the floor.

    Ten views of the board and three places of the sheet; a view is taken by itself when the board is still. Of the
    robot file only the camera's table changes, when you have said yes; a copy of it as it was stays beside it.

    Exit code: 0 done; 1 refused, nothing written; 2 not begun.
    """
    require_extra("calibrate camera", "cv2", "camera,cli")
    from giraff_setup.camera.calibrate import calibrate_camera  # noqa: PLC0415

    raise typer.Exit(calibrate_camera(which, pictures, robot, connect or (), file, as_json=as_json))


@calibrate.command()
def joystick(
    port: Annotated[
        str | None,
        typer.Option(metavar="PATH", help="Of the joystick board; else the robot file's.", show_default=False),
    ] = None,
    file: WrittenFile = None,
    as_json: AsJson = False,
) -> None:
    """Measure how the tilt sensor sits in the joystick: laid flat, tilted forward, tilted to the left.

    giraff_joystick must not run. Only mount_roll, mount_pitch and mount_yaw of the robot file's table joystick change,
    when you have said yes; a copy of it as it was stays beside it.

    Exit code: 0 done; 1 refused, nothing written; 2 not begun.
    """
    require_extra("calibrate joystick", "serial", "serial,cli")
    from giraff_setup.joystick.calibrate import calibrate_joystick  # noqa: PLC0415

    raise typer.Exit(calibrate_joystick(port, file, as_json=as_json))


@calibrate.command()
def ranger(file: WrittenFile = None, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """Measure the ultrasonic sensors before a wall: place ahead, axis and scale; y and height by your ruler.

    The robot backs 0.8 m, turns to either side, and does the same turned round. A sensor that the wall does not tell
    stays as it is. Of the robot file only these sensors' tables change, when you have said yes; a copy stays beside it.

    Exit code: 0 done; 1 refused, nothing written; 2 not begun.
    """
    require_extra("calibrate ranger", "numpy", "analysis,cli")
    from giraff_setup.ultrasonic.calibrate import calibrate_ranger  # noqa: PLC0415

    raise typer.Exit(calibrate_ranger(robot, connect or (), file, as_json=as_json))


@calibrate.command()
def scan(file: WrittenFile = None, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """Measure a laser scanner: place, direction, which way up it hangs, and what the robot's own parts hide from it.

    The robot turns once round on the spot and drives 1 m straight on, in any furnished room; a wall with a book before
    it checks this, if you like. Of the robot file only the scanner's table changes, when you have said yes; a copy
    stays beside it.

    Exit code: 0 done; 1 refused, nothing written; 2 not begun.
    """
    require_extra("calibrate scan", "numpy", "analysis,cli")
    from giraff_setup.scan.calibrate import calibrate_scan  # noqa: PLC0415

    raise typer.Exit(calibrate_scan(robot, connect or (), file, as_json=as_json))
