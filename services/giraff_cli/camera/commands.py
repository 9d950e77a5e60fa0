"""The verbs of `giraff camera`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Ending, Listen, Robot, require_extra

camera = typer.Typer(no_args_is_help=True, help="A robot's cameras: which there are, who looks, what they see.")

Name = Annotated[
    str | None, typer.Argument(metavar="[NAME]", help="Of the camera; else the only one.", show_default=False)
]


@camera.command("list")
def list_cameras(robot: Robot = None, connect: Connect = None, seconds: Listen = 1.0, as_json: AsJson = False) -> None:
    """The cameras of a robot: on or off, who looks, size, rate and what is wrong. It asks for no picture.

    Exit code: 0; 2 no robot, or none of its cameras is heard.
    """
    from giraff_cli.camera.look import list_cameras as run  # noqa: PLC0415

    raise typer.Exit(run(robot, connect or (), seconds, as_json=as_json))


@camera.command("view")
def view_camera(
    name: Name = None,
    robot: Robot = None,
    connect: Connect = None,
    save: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="No window: write one picture as JPEG, and end.", show_default=False),
    ] = None,
    seconds: Ending = None,
    as_json: AsJson = False,
) -> None:
    """What a camera of the robot sees, live, with its age. The robot says to all who asked for it.

    Exit code: 0; 1 there is no picture, with the reason, or the viewer or the disk failed; 2 no robot, no such camera.
    """
    if as_json and save is None:
        raise typer.BadParameter("--json tells of a picture that is written: add --save FILE")
    if save is None:
        require_extra("camera view", "rerun", "viewer,cli")
    from giraff_cli.camera.look import view_camera as run  # noqa: PLC0415

    raise typer.Exit(run(name, robot, connect or (), save, seconds, as_json=as_json))


@camera.command("board")
def print_board(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE.svg]", help="Else standard output.", show_default=False)
    ] = None,
) -> None:
    """The chessboard of `giraff calibrate camera`, as SVG for a sheet of A4 in landscape.

    Print it at 100 %, not fitted to the page, and measure both rulers: 100 mm. Glue it onto something flat and stiff.
    """
    from giraff_tools.chessboard import drawing  # noqa: PLC0415

    if file is None:
        typer.echo(drawing(), nl=False)
        return
    try:
        file.write_text(drawing(), encoding="utf-8")
    except OSError as error:
        typer.echo(f"giraff camera board: {file} cannot be written: {error.strerror}; name another file", err=True)
        raise typer.Exit(2) from error
    typer.echo(f"{file}: print it on A4 in landscape at 100 %, not fitted to the page; both rulers must be 100 mm.")
