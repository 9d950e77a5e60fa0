"""The options of `giraff localize`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, NoReturn

import typer

from giraff_cli.options import AsJson, Connect, Ending, Robot, require_extra
from giraff_tools import typed

if TYPE_CHECKING:
    from giraff_core.kinematics.pose import Pose

_REFUSED: Final = 2


def localize(
    map_file: Annotated[
        Path | None,
        typer.Option("--map", metavar="FILE", help="Floor plan: a room (.toml) or a grid (.yaml).", show_default=False),
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(metavar="X,Y,YAW", help="The robot is here on the map, like 1.5,-2,90deg.", show_default=False),
    ] = None,
    anywhere: Annotated[bool, typer.Option("--global", help="It may be anywhere on the map.")] = False,
    recording: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE", help="Of `giraff record`, instead of a robot.", show_default=False),
    ] = None,
    robot: Robot = None,
    connect: Connect = None,
    seconds: Ending = None,
    as_json: AsJson = False,
) -> None:
    """Where the robot is on a floor plan, with a line that says so, and how sure that is.

    With --map localization runs in this terminal until Ctrl-C, and looks anywhere or where --at says. Without it the
    one that runs on the network is shown, or is told --at or --global. With --from a recording goes through it, faster
    than real time, and a summary says how that went. It moves nothing.

    Exit code: 0 done; 1 the place is refused, with the reason, or a part of the
    recording cannot be read; 2 no robot, no map, or nobody has answered.
    """
    place = _place(at)
    if at is not None and anywhere:
        _refuse("--at and --global: the robot is here, or anywhere; one at a time")
    if recording is not None:
        if map_file is None:
            _refuse("--from: say on which floor plan the robot was, with --map FILE")
        if robot is not None or connect or seconds is not None:
            _refuse("--robot, --connect and --for are for a live robot; a recording is of one already, and has an end")
        _require("numpy", "mcap")
        from giraff_cli.localize.offline import localize as run  # noqa: PLC0415

        raise typer.Exit(run(recording, map_file, place, as_json=as_json))
    if map_file is not None:
        _require("numpy")
        from giraff_cli.localize.serve import serve  # noqa: PLC0415

        raise typer.Exit(serve(robot, connect or (), map_file, place, seconds, as_json=as_json))
    if at is not None or anywhere:
        from giraff_cli.localize.client import give_place  # noqa: PLC0415

        raise typer.Exit(give_place(robot, connect or (), place, as_json=as_json))
    from giraff_cli.localize.view import follow  # noqa: PLC0415

    raise typer.Exit(follow(robot, connect or (), seconds, as_json=as_json))


def _place(at: str | None) -> "Pose | None":
    try:
        return None if at is None else typed.pose(at)
    except ValueError as error:
        _refuse(f"--at: {error}")


def _require(*libraries: str) -> None:
    for library in libraries:
        require_extra("localize", library, "cli,localization" + (",record" if library == "mcap" else ""))


def _refuse(why: str) -> NoReturn:
    typer.echo(f"giraff localize: {why}", err=True)
    raise typer.Exit(_REFUSED)
