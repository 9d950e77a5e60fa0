"""The verbs of `giraff map`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated, Final

import typer

from giraff_cli.options import AsJson, Connect, Ending, Robot, WrittenFile, finite, require_extra

_REFUSED: Final = 2

maps = typer.Typer(no_args_is_help=True, help="Floor plans, on which the robot is looked for: see docs/maps.md.")


@maps.command()
def show(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A room (.toml), or a grid of ROS's map_server (.yaml).")
    ],
    svg: Annotated[Path | None, typer.Option(metavar="OUT", help="Also draw it as SVG.")] = None,
    as_json: AsJson = False,
) -> None:
    """Draw a floor plan, with its size: what localization will see in the file.

    Exit code: 0; 2 the file is no map that can be used, or OUT cannot be written.
    """
    from giraff_setup.map.show import show as run  # noqa: PLC0415

    raise typer.Exit(run(file, svg, as_json=as_json))


@maps.command()
def convert(
    room: Annotated[Path, typer.Argument(metavar="ROOM", help="A room (.toml).")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="A new file (.yaml); its image (.pgm) comes beside it.")],
    resolution: Annotated[
        float, typer.Option(metavar="METRES", min=0.001, callback=finite, help="Side of a cell.")
    ] = 0.05,
    as_json: AsJson = False,
) -> None:
    """Write a room as an occupancy grid, for ROS's map_server and nav2, or for an image editor.

    Exit code: 0 written; 2 not.
    """
    from giraff_setup.map.convert import convert as run  # noqa: PLC0415

    raise typer.Exit(run(room, out, resolution, as_json=as_json))


@maps.command()
def make(  # noqa: PLR0913, PLR0917  one argument an option
    plan: Annotated[
        Path, typer.Argument(metavar="NAME", help="Of the new files, like home or plans/home, without an ending.")
    ],
    recording: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE", help="Of `giraff record`, instead of a robot.", show_default=False),
    ] = None,
    onto: Annotated[
        bool, typer.Option("--onto", help="The plan NAME is there: redraw what the drive sees of it.")
    ] = False,
    calibrate: Annotated[
        bool, typer.Option("--calibrate", help="Write wheels and track, which a good plan tells, into the robot file.")
    ] = False,
    file: WrittenFile = None,
    robot: Robot = None,
    connect: Connect = None,
    seconds: Ending = None,
    as_json: AsJson = False,
) -> None:
    """Make a floor plan with a laser scanner, while somebody drives the robot round by any hand.

    The plan grows in this terminal, which also tells where the robot is on it, and what is missing. Ctrl-C ends the
    drive and writes NAME.yaml with its image NAME.pgm, and NAME.toml with straight walls; a second one gives it up.
    It moves nothing and overwrites nothing; --onto keeps the old files by their date.

    Exit code: 0 a good plan is written; 1 one that lacks something, or elsewhere, or
    the calibration is not, or a part of the recording cannot be read; 2 none.
    """
    if recording is not None and (robot is not None or connect or seconds is not None):
        why = "--robot, --connect and --for are for a live robot; a recording is of one already, and has an end"
        typer.echo(f"giraff map make: {why}", err=True)
        raise typer.Exit(_REFUSED)
    for library in ("numpy", *(["mcap"] if recording is not None else [])):
        require_extra("map make", library, "cli,localization" + (",record" if library == "mcap" else ""))
    if recording is not None:
        from giraff_setup.map.make.recorded import make as from_recording  # noqa: PLC0415

        raise typer.Exit(from_recording(plan, recording, onto=onto, calibrate=calibrate, file=file, as_json=as_json))
    from giraff_setup.map.make.live import make as run  # noqa: PLC0415

    raise typer.Exit(
        run(plan, robot, connect or (), seconds, onto=onto, calibrate=calibrate, file=file, as_json=as_json)
    )
